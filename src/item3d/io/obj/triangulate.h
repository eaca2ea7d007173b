// Polygons to triangles. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace item3d {

/// Triangles of one polygon, three indices into `corners` each, always corners.size() - 2 of them
/// and wound as the polygon is. Convex polygons become fans; others are cut by ear clipping in the
/// plane of the polygon's Newell normal (O'Rourke, Computational Geometry in C, 2nd ed., 1.4:
/// quadratic time); polygons of more than 4096 corners become fans whatever their shape.
std::vector<std::uint32_t> triangulate_polygon(std::span<const Vec3> corners);

}  // namespace item3d
