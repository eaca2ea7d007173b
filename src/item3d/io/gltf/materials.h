// Materials and textures of a glTF. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

#include <map>
#include <vector>

namespace item3d {

/// What the primitives that are shown have for one material.
struct MaterialUse {
    std::size_t primitives = 0;
    std::map<std::size_t, std::size_t> with_uv_map;  ///< number of them by TEXCOORD_n
};

/// The default of glTF, for primitives that name no material.
Material default_gltf_material();

/// Reads all factors of all materials into the model; textures only of those that are used (`uses`
/// by material). Pictures that cannot be read, and texture coordinates that are not there, are
/// warnings.
void read_gltf_materials(const SourceDocument& document, const std::vector<MaterialUse>& uses,
                         Model& model);

}  // namespace item3d
