// The layer of an edit: what its bake changed.
#pragma once

#include "item3d/field/bake/bake.h"
#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <map>
#include <vector>

namespace item3d {

/// What an edit was made of, and what came of it. All must live as long as the call.
struct BakedEdit {
    const std::vector<Material>& file_materials;  ///< as load_model() reads them
    const Model& model;                           ///< as the edit began from it
    const ModelEdit& edit;
    const std::map<int, UneditedPictures>& unedited;  ///< of bake()
};

/// Pictures, materials and primitives of the layer; the rest is the caller's to set.
EditLayer make_layer(const BakedEdit& baked);

}  // namespace item3d
