// Whether a layer's pictures lie on a model as they lay on the one that was edited.
#pragma once

#include "item3d/layers/layer.h"
#include "item3d/scene/model.h"

#include <string>

namespace item3d {

/// A sentence on what the layer was made for and this model has not; empty: it fits.
std::string misfit(const EditLayer& layer, const Model& model);

/// Whether the edited materials have the UV maps that they had; true where the layer does not say.
bool has_same_uvs(const EditLayer& layer, const Model& model);

/// The material of this model that the layer's material `index` is: of that index and name, else of
/// that name, else the only one where both have one. Throws InputError for none.
int material_like(const EditLayer& layer, int index, const Model& model);

}  // namespace item3d
