// Edits of materials and texture coordinates, made in a copy of a glTF's JSON. Internal to
// scene/io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/materials.h"
#include "item3d/io/save.h"

#include <span>
#include <vector>

namespace item3d {

/// Where a primitive of the model stands in the document.
struct PrimitiveUse {
    int index;  ///< into Model::primitives
    int mesh;
    int primitive;
    int node;      ///< -1: none
    int material;  ///< of the document, -1: glTF's default
    bool is_mirrored;
    const std::vector<Vec2>* uvs;
    std::size_t vertex_count;
};

/// Patches `builder`'s JSON, a copy of document.json. Materials in `edit` count from 0 as the
/// document's do; the number of the document's materials means glTF's default material.
void patch_gltf(const SourceDocument& document, std::span<const PrimitiveUse> uses,
                const ModelEdit& edit, GltfBuilder& builder);

/// How the texture coordinates of an edited material change.
struct UvPlan {
    bool has_new_uvs = false;
    /// The set that edited textures look at.
    std::size_t new_set = 0;
    /// The set that the old TEXCOORD_0 moves to when new_set is 0, else unused.
    std::optional<std::size_t> moved_set;
};

/// Writes the textures of one edit into `material`, which was `original` before its texture
/// coordinates moved.
void patch_material(const SourceDocument& document, const Json& original, const MaterialEdit& edit,
                    const UvPlan& plan, const std::string& name, Json& material,
                    GltfBuilder& builder);

/// Compressed attributes are named twice, in a primitive and in its Draco extension: makes those of
/// the extension agree with those of the primitive, which was `original` before.
void match_draco(const Json& original, Json& primitive);

/// Takes the Draco extension off the document's lists when no primitive has it any more.
void forget_unused_draco(Json& json);

/// Makes every texture of a material that looks at set 0 look at `set`.
void move_texture_coordinates(Json& material, std::size_t set);

}  // namespace item3d
