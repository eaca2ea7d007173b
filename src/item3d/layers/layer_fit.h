// The test of whether a layer's images match a model as they matched the edited one.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <string>

namespace item3d {

/// Returns a sentence on a requirement of the layer that the model lacks; empty: it fits.
std::string misfit(const EditLayer& layer, const Model& model);

/// True if the edited materials have the same UV maps, or the layer does not record them.
bool has_same_uvs(const EditLayer& layer, const Model& model);

/// Returns the model's material for the layer's material `index`: the one of the same index and
/// name, else of the same name, else the only one if model and layer have one each. Throws
/// InputError if there is none.
int material_like(const EditLayer& layer, int index, const Model& model);

}  // namespace item3d
