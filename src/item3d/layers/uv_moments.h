// A material's UV map in a few numbers, to tell whether a model still has it.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Means over the surface, by area, of u, v, their products, and their products with the place
/// within the model's box (in diagonals): the same for another order of vertices or triangles,
/// others for another UV map. Empty for a material without UVs.
std::vector<double> uv_moments(const Model& model, int material);

/// Whether they are of one UV map, to what a file's rounding changes.
bool same_uvs(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace item3d
