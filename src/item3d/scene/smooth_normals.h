// Normals for meshes whose file has none.
#pragma once

#include "item3d/core/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace item3d {

/// Area-weighted sum of face normals over equal positions (so that UV seams do not show), unit
/// length; (0, 0, 1) where nothing but degenerate triangles meets. `indices`: three a triangle.
std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::uint32_t> indices);

}  // namespace item3d
