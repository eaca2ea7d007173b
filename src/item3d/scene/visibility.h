// The test of whether a model is visible at all.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// True if these materials (indices into Model::materials) have a visible triangle: a triangle that
/// has an area, and whose material, texture and vertex colours are not wholly transparent.
bool is_visible(const Model& model, const std::vector<int>& materials);

/// True if any of the model's materials has a visible triangle.
bool is_visible(const Model& model);

}  // namespace item3d
