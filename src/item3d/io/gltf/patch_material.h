// Edits of one material, made in a copy of a glTF's JSON. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/references.h"
#include "item3d/io/save.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// How the texture coordinates of an edited material change.
struct UvPlan {
    bool has_new_uvs = false;
    /// The set that edited textures look at.
    std::size_t new_set = 0;
    /// The set that the old TEXCOORD_0 moves to when new_set is 0, else unused.
    std::optional<std::size_t> moved_set;
};

/// Writes the textures of one edit into `material`, which was `original` before its texture
/// coordinates moved. What else in the material shows the replaced pictures follows. Returns what
/// was replaced.
std::vector<ReplacedTexture> patch_material(const SourceDocument& document, const Json& original,
                                            const MaterialEdit& edit, const UvPlan& plan,
                                            const std::string& name, Json& material,
                                            GltfBuilder& builder);

}  // namespace item3d
