// The import of materials from one glTF document into another. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/content.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace item3d {

/// Importer of materials with their textures and images; reuses existing ones of equal content.
class MaterialImport {
  public:
    /// builder: destination of the import; own: content of the builder's document.
    MaterialImport(const DocumentContent& own, GltfBuilder& builder);

    /// Imports a material of the document of `content`; returns its index in the builder's
    /// document. uv_set: new UV set of textures that used set 0. name: name of the new material, if
    /// no equal one exists.
    std::size_t add(const DocumentContent& content, std::size_t material, std::size_t uv_set,
                    const std::string& name);
    /// Returns the index of glTF's default material.
    std::size_t add_default();

  private:
    std::size_t add_texture(const DocumentContent& content, std::size_t texture);
    std::size_t add_image(const DocumentContent& content, std::size_t image);
    std::size_t add_sampler(const Json& sampler);

    GltfBuilder& builder_;
    std::map<std::string, std::size_t> materials_, textures_, images_;
    std::map<std::size_t, std::string> own_;  ///< content of the document's own materials, by index
    std::optional<std::size_t> default_;
};

}  // namespace item3d
