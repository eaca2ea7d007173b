// The conversion of a model of another format to a new glTF document. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/io/save.h"

#include <memory>

namespace item3d {

/// Returns the document. Model::primitives[i] becomes primitive 0 of mesh i in node i. Materials
/// keep their indices. Textures and texture coordinates that `edit` replaces are left out.
std::shared_ptr<SourceDocument> make_gltf(const Model& model, const ModelEdit& edit);

}  // namespace item3d
