// Whether a UV map gives each place of a surface texels of its own.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Why the UVs of primitives that share a texture can't be baked into, in words ("it has no UV
/// map", "its UV map overlaps itself", ...); empty when they can. UVs beyond [0, 1] are no problem
/// by themselves where the texture repeats: what counts is whether each texel shows one place. Nor
/// do triangles overlap that lie on each other in space as well, such as both sides of a leaf.
std::string find_uv_problem(const Model& model, const std::vector<int>& primitives);

}  // namespace item3d
