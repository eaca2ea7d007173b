// The moments of a material's UV map, for recognising it.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns area-weighted means over the surface of u, v, their products, and their products with
/// the position in the model's box (in diagonals): independent of the order of vertices and
/// triangles, different for another UV map. Empty for a material without UVs.
std::vector<double> uv_moments(const Model& model, int material);

/// True if both are of one UV map, up to a file's rounding.
bool same_uvs(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace item3d
