// The moments of a material's UV map, for recognising it.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Returns means of these values over the surface, weighted by area: u, v, their products, and
/// their products with the position in the model's box (in units of its diagonal). The means do not
/// depend on the order of vertices and triangles, and differ for another UV map. Empty for a
/// material without UVs.
std::vector<double> uv_moments(const Model& model, int material);

/// True if `a` and `b` are the moments of one UV map, up to the rounding of values in files.
bool same_uvs(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace item3d
