// The functions of a multi-resolution hash grid for one point and one level (Mueller et al. 2022,
// "Instant Neural Graphics Primitives"). They are independent of LibTorch and run on the CPU's
// threads and in CUDA grids.
//
// A level is a lattice of (resolution + 1)^3 vertices over the unit cube, with F features for each
// vertex. Coarse levels store every vertex. On finer levels there are more vertices than table
// entries. There, vertices share entries by a spatial hash, and the network that follows resolves
// the collisions.
//
//     features = sum_c w_c table[entry_c]        over the cell's corners c, at bits (x, y, z) of c
//     w_c = prod_axis (bit ? f : 1 - f)          f: fraction of the point within its cell
//     entry = (z (r + 1) + y) (r + 1) + x        dense, r = resolution
//     entry = (x ^ 2654435761 y ^ 805459861 z) mod entries        hashed (equation 4)
//
// The backward pass has the gradient g with respect to the features. The gradient with respect to
// table[entry_c] is w_c g. For the gradient with respect to the point's x, the values g .
// table[entry_c] are interpolated in y and z on the cell's faces x = 0 and x = 1. The gradient is r
// times the value on face x = 1 minus the value on face x = 0. The same holds for y and z.
//
//     table     [entries, F]:  level 0 | level 1 | ..        first: a level's first entry
//     features  [P, L F]:      level 0's F | level 1's F | .. of point 0, then of point 1
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cstddef>
#include <cstdint>

namespace item3d {

struct HashGridLevel {
    int resolution = 16;        ///< cells along an edge of the unit cube
    std::uint32_t first = 0;    ///< index of the level's first entry in the whole table
    std::uint32_t entries = 0;  ///< a power of two when hashed
    bool hashed = false;
};

/// The cell of a point in one level, and the point's position in the cell.
struct HashGridCell {
    int x = 0, y = 0, z = 0;
    Vec3 fraction{0.0f};
    Vec3 slope{0.0f};  ///< d fraction / d point; 0 along axes on which the point was clamped

    /// True if both cells have the same corners.
    ITEM3D_HOST_DEVICE bool is_same_cell(const HashGridCell& other) const {
        return x == other.x && y == other.y && z == other.z;
    }
};

ITEM3D_HOST_DEVICE inline void locate_axis(float p, int resolution, int& cell, float& fraction,
                                           float& slope) {
    const float scaled = p * static_cast<float>(resolution);
    if (!(scaled > 0.0f)) {  // NaN counts as outside
        cell = 0, fraction = 0.0f, slope = 0.0f;
    } else if (scaled >= static_cast<float>(resolution)) {
        cell = resolution - 1, fraction = 1.0f, slope = 0.0f;
    } else {
        cell = static_cast<int>(scaled);
        fraction = scaled - static_cast<float>(cell);
        slope = static_cast<float>(resolution);
    }
}

ITEM3D_HOST_DEVICE inline HashGridCell locate(const HashGridLevel& level, Vec3 point) {
    HashGridCell cell;
    locate_axis(point.x, level.resolution, cell.x, cell.fraction.x, cell.slope.x);
    locate_axis(point.y, level.resolution, cell.y, cell.fraction.y, cell.slope.y);
    locate_axis(point.z, level.resolution, cell.z, cell.fraction.z, cell.slope.z);
    return cell;
}

/// Writes the entries of the cell's eight corners, relative to the level's first. Corner c lies at
/// (c & 1, c >> 1 & 1, c >> 2 & 1).
ITEM3D_HOST_DEVICE inline void corner_entries(const HashGridLevel& level, const HashGridCell& cell,
                                              std::uint32_t entries[8]) {
    const std::uint32_t x = static_cast<std::uint32_t>(cell.x);
    const std::uint32_t y = static_cast<std::uint32_t>(cell.y);
    const std::uint32_t z = static_cast<std::uint32_t>(cell.z);
    if (level.hashed) {
        // These primes are from Mueller et al. 2022, equation 4.
        const std::uint32_t hash_y[2] = {y * 2654435761u, (y + 1) * 2654435761u};
        const std::uint32_t hash_z[2] = {z * 805459861u, (z + 1) * 805459861u};
        const std::uint32_t mask = level.entries - 1;
        for (std::uint32_t c = 0; c < 8; ++c) {
            entries[c] = ((x + (c & 1)) ^ hash_y[c >> 1 & 1] ^ hash_z[c >> 2]) & mask;
        }
    } else {
        const std::uint32_t row = static_cast<std::uint32_t>(level.resolution) + 1;
        const std::uint32_t base = (z * row + y) * row + x;
        for (std::uint32_t c = 0; c < 8; ++c) {
            entries[c] = base + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * row * row;
        }
    }
}

/// Writes the trilinear weights of the corners. Their sum is 1.
ITEM3D_HOST_DEVICE inline void corner_weights(const HashGridCell& cell, float weights[8]) {
    const Vec3 f = cell.fraction;
    const float x[2] = {1.0f - f.x, f.x};
    const float yz[4] = {(1.0f - f.y) * (1.0f - f.z), f.y * (1.0f - f.z), (1.0f - f.y) * f.z,
                         f.y * f.z};
    for (int c = 0; c < 8; ++c)
        weights[c] = x[c & 1] * yz[c >> 1];
}

/// Sets out[F] to the interpolated features. table: the level's own entries, [entries, F].
template <int F>
ITEM3D_HOST_DEVICE inline void encode_level(const HashGridLevel& level, const float* table,
                                            Vec3 point, float* out) {
    const HashGridCell cell = locate(level, point);
    std::uint32_t entries[8];
    float weights[8];
    corner_entries(level, cell, entries);
    corner_weights(cell, weights);
    float sum[F] = {};
    for (int c = 0; c < 8; ++c) {
        const float* features = table + static_cast<std::size_t>(entries[c]) * F;
        for (int f = 0; f < F; ++f)
            sum[f] += weights[c] * features[f];
    }
    for (int f = 0; f < F; ++f)
        out[f] = sum[f];
}

/// Returns the gradient of dot(encode_level(point), grad[F]) with respect to the point.
template <int F>
ITEM3D_HOST_DEVICE inline Vec3 encode_level_point_gradient(const HashGridLevel& level,
                                                           const float* table, Vec3 point,
                                                           const float* grad) {
    const HashGridCell cell = locate(level, point);
    std::uint32_t entries[8];
    corner_entries(level, cell, entries);
    float value[8];
    for (int c = 0; c < 8; ++c) {
        const float* features = table + static_cast<std::size_t>(entries[c]) * F;
        value[c] = 0.0f;
        for (int f = 0; f < F; ++f)
            value[c] += grad[f] * features[f];
    }
    const Vec3 t = cell.fraction;
    const Vec3 s = Vec3(1.0f) - t;
    const float dx = s.y * s.z * (value[1] - value[0]) + t.y * s.z * (value[3] - value[2]) +
                     s.y * t.z * (value[5] - value[4]) + t.y * t.z * (value[7] - value[6]);
    const float dy = s.x * s.z * (value[2] - value[0]) + t.x * s.z * (value[3] - value[1]) +
                     s.x * t.z * (value[6] - value[4]) + t.x * t.z * (value[7] - value[5]);
    const float dz = s.x * s.y * (value[4] - value[0]) + t.x * s.y * (value[5] - value[1]) +
                     s.x * t.y * (value[6] - value[2]) + t.x * t.y * (value[7] - value[3]);
    return Vec3(dx, dy, dz) * cell.slope;
}

inline constexpr int max_hash_grid_levels = 32;

/// Parameters of a whole grid over P points, for launches with one index for each level and point.
struct HashGridParameters {
    HashGridLevel levels[max_hash_grid_levels];
    int level_count;      ///< L
    int entry_width;      ///< F
    std::int64_t count;   ///< P
    const float* points;  ///< [P, 3]
    const float* table;   ///< [entries, F]
    float* features;      ///< [P, L * F]

    // The backward pass uses the following arrays.
    const float* feature_gradient;  ///< [P, L * F]
    float* point_gradient;          ///< [P, 3]
    Accumulator table_gradient;     ///< [entries, F]
    std::uint8_t* touched;          ///< [entries] is set to 1 for entries that a point reads
};

ITEM3D_HOST_DEVICE inline Vec3 hash_grid_point(const HashGridParameters& p, std::int64_t i) {
    return Vec3(p.points[3 * i], p.points[3 * i + 1], p.points[3 * i + 2]);
}

/// Encodes one point in one level. index: level * P + point, so that adjacent threads read one
/// level's table.
template <int F>
ITEM3D_HOST_DEVICE inline void hash_grid_forward(const HashGridParameters& p, std::int64_t index) {
    const std::int64_t l = index / p.count, i = index % p.count;
    const HashGridLevel& level = p.levels[l];
    encode_level<F>(level, p.table + static_cast<std::size_t>(level.first) * F,
                    hash_grid_point(p, i), p.features + (i * p.level_count + l) * F);
}

/// Computes the gradient with respect to one point. index: the point's.
template <int F>
ITEM3D_HOST_DEVICE inline void hash_grid_points_backward(const HashGridParameters& p,
                                                         std::int64_t index) {
    Vec3 sum(0.0f);
    for (int l = 0; l < p.level_count; ++l) {
        const HashGridLevel& level = p.levels[l];
        sum += encode_level_point_gradient<F>(
            level, p.table + static_cast<std::size_t>(level.first) * F, hash_grid_point(p, index),
            p.feature_gradient + (index * p.level_count + l) * F);
    }
    for (int c = 0; c < 3; ++c)
        p.point_gradient[3 * index + c] = sum[c];
}

/// Adds one point's gradients to its eight entries, and marks them. index: level * P + point.
template <int F>
ITEM3D_HOST_DEVICE inline void hash_grid_table_backward(const HashGridParameters& p,
                                                        std::int64_t index) {
    const std::int64_t l = index / p.count, i = index % p.count;
    const HashGridLevel& level = p.levels[l];
    const HashGridCell cell = locate(level, hash_grid_point(p, i));
    std::uint32_t entries[8];
    float weights[8];
    corner_entries(level, cell, entries);
    corner_weights(cell, weights);
    const float* gradient = p.feature_gradient + (i * p.level_count + l) * F;
    for (int c = 0; c < 8; ++c) {
        const std::int64_t entry = static_cast<std::int64_t>(level.first) + entries[c];
        p.touched[entry] = 1;
        for (int f = 0; f < F; ++f)
            p.table_gradient.add(entry * F + f, weights[c] * gradient[f]);
    }
}

}  // namespace item3d
