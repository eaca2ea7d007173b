// Reading of a glTF's materials and textures. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

#include <map>
#include <vector>

namespace item3d {

/// Use of one material by the visible primitives.
struct MaterialUse {
    std::size_t primitives = 0;
    std::map<std::size_t, std::size_t> with_uv_map;  ///< number of primitives by TEXCOORD_n
};

/// Returns glTF's default material, for primitives without one.
Material default_gltf_material();

/// Reads the factors of all materials into the model, and the textures of the used materials. uses:
/// one entry for each material. Warns of unreadable images and of missing texture coordinates.
void read_gltf_materials(const SourceDocument& document, const std::vector<MaterialUse>& uses,
                         Model& model);

}  // namespace item3d
