// The import of vertices and triangles from one glTF document into another. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/content.h"

#include <cstddef>
#include <map>
#include <string>

namespace item3d {

/// Importer of geometry; adds equal content once.
class GeometryImport {
  public:
    explicit GeometryImport(GltfBuilder& builder) : builder_(builder) {}

    /// Gives `primitive` the vertices, triangles and morph targets of `edited`. `primitive` belongs
    /// to the builder's document; `edited` is an uncompressed primitive of the document of
    /// `content`. uv_set: new UV set of textures that used set 0.
    void replace(DocumentContent& content, const Json& edited, std::size_t uv_set, Json& primitive);

  private:
    Json add_attributes(DocumentContent& content, const Json& attributes);

    GltfBuilder& builder_;
    std::map<std::string, std::size_t> accessors_;  ///< by content
};

}  // namespace item3d
