// Lookup of occlusion that is stored on grids over triangles. Interpolation is linear within each
// small triangle of a grid.
//
//     j                                  resolution 3; points (i, j): barycentrics i / 3, j / 3
//     3  9
//     2  7 8                             index = j (resolution + 1) - j (j - 1) / 2 + i
//     1  4 5 6                           values [points, 2]: openness in 1/255 in front, behind
//     0  0 1 2 3
//        0 1 2 3  i
//
//     cell (i, j) with fractions fx, fy:
//     lower triangle, fx + fy <= 1:  corner (i, j), to_right = fx, to_below = fy
//     upper triangle:                corner (i + 1, j + 1), to_right = 1 - fy, to_below = 1 - fx
//     value = corner + to_right (right - corner) + to_below (below - corner)
//     Here right = (i + 1, j) and below = (i, j + 1) for both triangles.
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cstdint>

namespace item3d::kernels {

/// Returns the index of the point with `resolution` * barycentrics (i, j, resolution - i - j) in a
/// triangle's grid. The grid has rows of decreasing length, and j is the row.
ITEM3D_HOST_DEVICE inline std::int64_t grid_index(int resolution, int i, int j) {
    const std::int64_t row = j;
    return row * (resolution + 1) - row * (row - 1) / 2 + i;
}

struct OcclusionParameters {
    const float* normals;            ///< [V, 3]
    const float* positions;          ///< [V, 3]
    const std::int32_t* triangles;   ///< [T, 3]
    const std::int64_t* first;       ///< [T] first point of each triangle
    const std::int32_t* resolution;  ///< [T] steps along an edge
    /// [points, 2] openness in units of 1/255, on the normal's side and on the opposite side.
    const std::uint8_t* values;
    const float* barycentrics;     ///< [N, H, W, 2]
    const std::int32_t* triangle;  ///< [N, H, W]
    const std::int64_t* pixel;     ///< [P]
    const float* seen_normal;      ///< [P, 3] turned towards the viewer
    float* openness;               ///< [P]
};

ITEM3D_HOST_DEVICE inline Vec3 row3(const float* rows, std::int64_t row) {
    return Vec3(rows[3 * row], rows[3 * row + 1], rows[3 * row + 2]);
}

/// Interpolates linearly within the grid cell around the pixel's centre.
ITEM3D_HOST_DEVICE inline void occlusion_at(const OcclusionParameters& p, std::int64_t index) {
    const std::int64_t pixel = p.pixel[index];
    const std::int64_t t = p.triangle[pixel];
    const float b0 = p.barycentrics[2 * pixel], b1 = p.barycentrics[2 * pixel + 1];
    const float weights[3] = {b0, b1, 1 - b0 - b1};
    Vec3 normal(0.0f);
    for (int k = 0; k < 3; ++k)
        normal += weights[k] * row3(p.normals, p.triangles[3 * t + k]);
    if (!(glm::dot(normal, normal) > 1e-20f)) {
        const Vec3 corner = row3(p.positions, p.triangles[3 * t]);
        normal = glm::cross(row3(p.positions, p.triangles[3 * t + 1]) - corner,
                            row3(p.positions, p.triangles[3 * t + 2]) - corner);
    }
    const int side = glm::dot(normal, row3(p.seen_normal, index)) < 0 ? 1 : 0;

    const int resolution = p.resolution[t];
    const float x = b0 * resolution, y = b1 * resolution;
    int i = x > 0 ? static_cast<int>(x) : 0, j = y > 0 ? static_cast<int>(y) : 0;
    // Rounding must not cross the third edge.
    i = i < resolution ? i : resolution - 1;
    j = j < resolution - i ? j : resolution - 1 - i;
    const float fx = x - i, fy = y - j;
    const std::uint8_t* grid = p.values + 2 * p.first[t] + side;
    const auto at = [&](int column, int row) {
        return static_cast<float>(grid[2 * grid_index(resolution, column, row)]);
    };
    // The sum uses differences, so that equal corners give exactly their value.
    const bool lower = fx + fy <= 1 || i + j + 2 > resolution;
    const float right = at(i + 1, j), below = at(i, j + 1);
    const float corner = lower ? at(i, j) : at(i + 1, j + 1);
    const float to_right = lower ? fx : 1 - fy, to_below = lower ? fy : 1 - fx;
    float value = corner + to_right * (right - corner) + to_below * (below - corner);
    value /= 255;
    p.openness[index] = value < 0 ? 0.0f : (value > 1 ? 1.0f : value);
}

}  // namespace item3d::kernels
