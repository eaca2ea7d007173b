// The edit of one material in a copy of a glTF's JSON. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/references.h"
#include "item3d/io/save.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Changes of an edited material's texture coordinates.
struct UvPlan {
    bool has_new_uvs = false;
    /// UV set of the edited textures.
    std::size_t new_set = 0;
    /// UV set to which the old TEXCOORD_0 moves; used only if new_set is 0.
    std::optional<std::size_t> moved_set;
};

/// Writes the textures of one edit into `material`, which was `original` before its texture
/// coordinates moved. Updates other uses of the replaced images in the material. Returns the
/// replaced textures.
std::vector<ReplacedTexture> patch_material(const SourceDocument& document, const Json& original,
                                            const MaterialEdit& edit, const UvPlan& plan,
                                            const std::string& name, Json& material,
                                            GltfBuilder& builder);

}  // namespace item3d
