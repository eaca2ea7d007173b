// The test of whether a layer's images match a model as they matched the model that was edited.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <string>

namespace item3d {

/// Returns the end of a sentence that names a requirement of the layer that the model does not
/// meet; empty if the layer fits.
std::string misfit(const EditLayer& layer, const Model& model);

/// True if the model's materials have the UV maps that they had in the edit, or if the layer does
/// not record them.
bool has_same_uvs(const EditLayer& layer, const Model& model);

/// Returns the model's material for the layer's material `index`: the one with the same index and
/// name, else one with the same name, else the only one if model and layer have one material each.
/// Throws InputError if there is none.
int material_like(const EditLayer& layer, int index, const Model& model);

}  // namespace item3d
