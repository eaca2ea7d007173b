// Parts of glTF documents by their content, so that those of two documents can be compared.
// Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Calls f for every index of a texture in a material.
void for_each_texture_index(Json& material, const std::function<void(Json&)>& f);

/// Hashes of images, textures, materials and geometry of one document, each made once.
class DocumentContent {
  public:
    /// The document must live as long.
    explicit DocumentContent(const SourceDocument& document);

    const SourceDocument& document() const { return document_; }

    /// image_sha256(); empty where it cannot be read.
    const std::string& image(std::size_t index) const { return images_.at(index); }
    /// Sampler and images of a texture.
    std::string texture(std::size_t index) const;
    /// All of a material but its name.
    std::string material(std::size_t index) const;
    /// Everything of an accessor but its place.
    const std::string& accessor(std::size_t index);
    /// Vertices, triangles and morph targets of a primitive.
    const std::string& geometry(std::size_t mesh, std::size_t primitive);

  private:
    const SourceDocument& document_;
    SourceDocument decoded_;  ///< a copy whose compressed primitives are decompressed
    std::vector<std::string> images_;
    std::map<std::size_t, std::string> accessors_;
    std::map<std::pair<std::size_t, std::size_t>, std::string> geometry_;
};

/// The set of texture coordinates of an edited primitive that the source's TEXCOORD_0 became; no
/// value where the source has none, or nothing of it is left.
std::optional<std::size_t> moved_uv_set(const SourceDocument& source, const Json& primitive,
                                        const SourceDocument& edited, const Json& edited_primitive);

}  // namespace item3d
