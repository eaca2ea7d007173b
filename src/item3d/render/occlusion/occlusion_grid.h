// The grids of points over triangles at which occlusion is stored, and the points that triangles
// share.
#pragma once

#include "item3d/core/math.h"
#include "item3d/render/geometry.h"

#include <cstdint>
#include <vector>

namespace item3d {

struct OcclusionGrid {
    at::Tensor positions;                  ///< [V, 3] float32; all tensors are on the CPU
    at::Tensor normals;                    ///< [V, 3]
    at::Tensor triangles;                  ///< [T, 3] int32
    at::Tensor neighbours;                 ///< [T, 3] int32, as Geometry::neighbours
    std::vector<std::int32_t> resolution;  ///< [T] number of steps along an edge, a power of two
    std::vector<std::int64_t> first;       ///< [T + 1] index of the first point of each triangle
    /// Groups of points with equal position and normal: group g has the points member[begin[g]] up
    /// to, not including, member[begin[g + 1]].
    std::vector<std::int64_t> member, begin;
    std::vector<std::int32_t> triangle;  ///< triangle of each point
    std::vector<std::uint64_t> key;      ///< hash of each point's position and normal

    std::int64_t points() const { return first.back(); }

    /// A point of a grid. It is moved slightly into its triangle, so that it sees geometry that
    /// touches the triangle's edge from the correct side.
    struct Point {
        Vec3 position, normal, face;  ///< face: the triangle's unit normal; 0 without area
    };
    Point point(std::int64_t index) const;
    float diagonal = 0;  ///< length of the bounding box's diagonal
    float farthest = 0;  ///< largest coordinate, which scales rounding errors
};

OcclusionGrid make_occlusion_grid(const Geometry& geometry, float spacing, std::int64_t max_points);

/// Makes `values` [points, 2] equal on both sides of an edge between a fine grid and a coarse grid.
/// Points of the fine grid on this edge get the coarse grid's interpolated values.
void join_grids(const OcclusionGrid& grid, std::uint8_t* values);

}  // namespace item3d
