// The test of whether a UV map gives each surface point its own texel.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the reason, in words, for which the UVs of primitives that share a texture cannot be
/// baked into ("it has no UV map", "its UV map overlaps itself", ...); empty when they can. UVs
/// beyond [0, 1] are valid where the texture repeats and each texel shows one surface point.
/// Triangles that also coincide in space, such as both sides of a leaf, do not count as
/// overlapping.
std::string find_uv_problem(const Model& model, const std::vector<int>& primitives);

}  // namespace item3d
