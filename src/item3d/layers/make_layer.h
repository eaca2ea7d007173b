// The construction of a layer from an edit's bake.
#pragma once

#include "item3d/field/bake/bake.h"
#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <map>
#include <vector>

namespace item3d {

/// Input and result of an edit, which must outlive the call.
struct BakedEdit {
    const std::vector<Material>& file_materials;  ///< unmodified, from load_model()
    const Model& model;                           ///< the edit's starting point
    const ModelEdit& edit;
    const std::map<int, UneditedImages>& unedited;  ///< from bake()
};

/// Returns a layer with images, materials and primitives; the caller sets the rest.
EditLayer make_layer(const BakedEdit& baked);

}  // namespace item3d
