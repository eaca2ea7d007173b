// Content hashes of parts of glTF documents, for comparing two documents. Internal to io.
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

/// Hashes of images, textures, materials and geometry of one document, computed on demand.
class DocumentContent {
  public:
    /// The document must outlive this object.
    explicit DocumentContent(const SourceDocument& document);

    const SourceDocument& document() const { return document_; }

    /// Returns image_sha256() of an image; empty if the image is unreadable.
    const std::string& image(std::size_t index) const { return images_.at(index); }
    /// Returns the hash of a texture's sampler and images.
    std::string texture(std::size_t index) const;
    /// Returns the hash of a material without its name.
    std::string material(std::size_t index) const;
    /// Returns the hash of an accessor, independent of its location.
    const std::string& accessor(std::size_t index);
    /// Returns the hash of a primitive's vertices, triangles and morph targets.
    const std::string& geometry(std::size_t mesh, std::size_t primitive);

  private:
    const SourceDocument& document_;
    SourceDocument decoded_;  ///< a copy whose compressed primitives are decompressed
    std::vector<std::string> images_;
    std::map<std::size_t, std::string> accessors_;
    std::map<std::pair<std::size_t, std::size_t>, std::string> geometry_;
};

/// Returns the texture coordinate set to which an edited primitive moved the source's TEXCOORD_0;
/// no value if the source has no TEXCOORD_0, or the edit dropped it.
std::optional<std::size_t> moved_uv_set(const SourceDocument& source, const Json& primitive,
                                        const SourceDocument& edited, const Json& edited_primitive);

}  // namespace item3d
