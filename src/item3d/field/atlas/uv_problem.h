// The test of whether a UV map gives each surface point its own texel.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the reason, in words, why textures cannot be baked with the UVs of these primitives,
/// which share a texture: "it has no UV map", "its UV map overlaps itself", ... Empty if textures
/// can be baked. UVs beyond [0, 1] are valid if the texture repeats and each texel shows one
/// surface point. Triangles that also coincide in space, such as both sides of a leaf, do not count
/// as overlapping.
std::string find_uv_problem(const Model& model, const std::vector<int>& primitives);

}  // namespace item3d
