// Edits of materials and texture coordinates in a copy of a glTF's JSON. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/save.h"

#include <span>
#include <vector>

namespace item3d {

/// Location of a model's primitive in the document.
struct PrimitiveUse {
    int index;  ///< index into Model::primitives
    int mesh;
    int primitive;
    int node;      ///< -1 if none
    int material;  ///< index in the document; -1 for glTF's default material
    bool is_mirrored;
    const std::vector<Vec2>* uvs;
    std::size_t vertex_count;
};

/// Patches `builder`'s JSON, a copy of document.json. Material indices in `edit` equal those of the
/// document. One further index, equal to the number of the document's materials, denotes glTF's
/// default material.
void patch_gltf(const SourceDocument& document, std::span<const PrimitiveUse> uses,
                const ModelEdit& edit, GltfBuilder& builder);

}  // namespace item3d
