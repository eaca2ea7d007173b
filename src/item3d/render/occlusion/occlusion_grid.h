// Where occlusion is stored: grids of points over triangles, with what they share found out.
#pragma once

#include "item3d/core/math.h"
#include "item3d/render/geometry.h"

#include <cstdint>
#include <vector>

namespace item3d {

struct OcclusionGrid {
    at::Tensor positions;                  ///< [V, 3] float32 on the CPU, as are all of these
    at::Tensor normals;                    ///< [V, 3]
    at::Tensor triangles;                  ///< [T, 3] int32
    at::Tensor neighbours;                 ///< [T, 3] int32, as Geometry::neighbours
    std::vector<std::int32_t> resolution;  ///< [T] steps along an edge, a power of two
    std::vector<std::int64_t> first;       ///< [T + 1] each triangle's first point
    /// Points that are one: same position, same normal. Group g has the points
    /// member[begin[g]] to member[begin[g + 1]].
    std::vector<std::int64_t> member, begin;
    std::vector<std::int32_t> triangle;  ///< of each point
    std::vector<std::uint64_t> key;      ///< of each point, from its position and normal

    std::int64_t points() const { return first.back(); }

    /// One point of a grid: a little inside its triangle, so that what stands on an edge is seen
    /// from the right side of it.
    struct Point {
        Vec3 position, normal, face;  ///< face: the triangle's unit normal; 0: it has no area
    };
    Point point(std::int64_t index) const;
    float diagonal = 0;  ///< of the box around all positions
    float farthest = 0;  ///< largest coordinate, to judge rounding by
};

OcclusionGrid make_occlusion_grid(const Geometry& geometry, float spacing,
                                  std::int64_t most_points);

/// Makes values [points, 2] equal on both sides of edges between a fine grid and a coarse one, by
/// giving the fine one there what the coarse one interpolates.
void join_grids(const OcclusionGrid& grid, std::uint8_t* values);

}  // namespace item3d
