// Materials of one glTF document taken over into another. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/content.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace item3d {

/// Takes over materials with their textures and images; what the document has already, by content,
/// is not added again.
class MaterialImport {
  public:
    /// builder: of the document that `own` is the content of, and into which all goes.
    MaterialImport(const DocumentContent& own, GltfBuilder& builder);

    /// The index of a material of `content`'s document in the builder's. uv_set: where textures
    /// that look at set 0 find it now. name: of a material that is added.
    std::size_t add(const DocumentContent& content, std::size_t material, std::size_t uv_set,
                    const std::string& name);
    /// The same for glTF's default material.
    std::size_t add_default();

  private:
    std::size_t add_texture(const DocumentContent& content, std::size_t texture);
    std::size_t add_image(const DocumentContent& content, std::size_t image);
    std::size_t add_sampler(const Json& sampler);

    GltfBuilder& builder_;
    std::map<std::string, std::size_t> materials_, textures_, images_;
    std::map<std::size_t, std::string> own_;  ///< content of the document's own materials
    std::optional<std::size_t> default_;
};

}  // namespace item3d
