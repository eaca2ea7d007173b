// Triangulation of polygons. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace item3d {

/// Returns the triangles of one polygon as three indices into `corners` each. There are always
/// corners.size() - 2 triangles, and they have the polygon's winding. Convex polygons become fans;
/// others are cut by ear clipping in the plane of the polygon's Newell normal (O'Rourke,
/// Computational Geometry in C, 2nd ed., 1.4: quadratic time). Polygons of more than 4096 corners
/// always become fans.
std::vector<std::uint32_t> triangulate_polygon(std::span<const Vec3> corners);

}  // namespace item3d
