// Resampling of equirectangular maps onto cube texels.
//
//     cube[texel] = sum_k w_k map(u_k, v_k) / sum_k w_k      k: samples x samples points of a texel
//     w = (1 + s^2 + t^2)^(-3/2)        solid angle of a step of s and t on the face
//     u = atan2(x, -z) / (2 pi) + 1/2      v = acos(y) / pi      of the unit direction (x, y, z)
//
//     map   [H, W, 3]           row 0 at +Y; the middle column at -Z, a quarter further right at +X
//     cube  [6, size, size, 3]  of cube.h
//
// Lookups are bilinear. Columns wrap around, and rows end at the poles. The map's gradient is the
// transpose, which has the same taps with the same weights.
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

struct EquirectangularParameters {
    const float* map;  ///< [H, W, 3]
    int height;        ///< H
    int width;         ///< W
    int size;          ///< S, edge of the cube's faces
    int samples;       ///< sub-samples along each side of a texel
    float* cube;       ///< [6, S, S, 3]

    // Members of the backward pass.
    const float* cube_gradient;  ///< [6, S, S, 3]
    Accumulator map_gradient;    ///< [H, W, 3]
};

/// Returns parameters with the sizes and the number of samples. Along each axis, a cube texel has
/// twice as many samples as it spans texels of the map, and at least two. At a face's centre it
/// spans height / (2 size) texels.
inline EquirectangularParameters equirectangular_parameters(int height, int width, int size) {
    EquirectangularParameters p{};
    p.height = height;
    p.width = width;
    p.size = size;
    const int texels = (height + size - 1) / size;
    p.samples = texels > 2 ? texels : 2;
    return p;
}

/// Calls f(map texel, weight) for the samples whose weighted mean is a cube texel. index: the cube
/// texel's index into [6, S, S]. The samples are bilinear, weighted by their solid angle, and dense
/// enough to miss no texel.
template <typename F>
ITEM3D_HOST_DEVICE inline void for_each_equirectangular_tap(const EquirectangularParameters& p,
                                                            std::int64_t index, const F& f) {
    const int face = static_cast<int>(index / (p.size * p.size));
    const int row = static_cast<int>(index / p.size % p.size);
    const int column = static_cast<int>(index % p.size);
    const int fine = p.size * p.samples;
    float total = 0;
    for (int j = 0; j < p.samples; ++j) {
        for (int i = 0; i < p.samples; ++i) {
            const float s = texel_centre(column * p.samples + i, fine);
            const float t = texel_centre(row * p.samples + j, fine);
            const float squared = 1 + s * s + t * t;
            total += 1 / (squared * std::sqrt(squared));
        }
    }
    for (int j = 0; j < p.samples; ++j) {
        for (int i = 0; i < p.samples; ++i) {
            const float s = texel_centre(column * p.samples + i, fine);
            const float t = texel_centre(row * p.samples + j, fine);
            const float squared = 1 + s * s + t * t, length = std::sqrt(squared);
            const float weight = 1 / (squared * length * total);
            const Vec3 d = cube_direction(face, s, t);
            const float y = d.y / length;
            const float u = std::atan2(d.x, -d.z) * (0.5f / pi) + 0.5f;
            const float v = std::acos(y < -1 ? -1.0f : (y > 1 ? 1.0f : y)) / pi;
            const float x = u * p.width - 0.5f;
            float z = v * p.height - 0.5f;
            z = z < 0 ? 0.0f : (z > p.height - 1 ? static_cast<float>(p.height - 1) : z);
            const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(z);
            const int y1 = y0 + 1 < p.height ? y0 + 1 : y0;
            const float fx = x - x0, fy = z - y0;
            const int left = (x0 + p.width) % p.width, right = (x0 + 1) % p.width;
            f(y0 * p.width + left, weight * (1 - fx) * (1 - fy));
            f(y0 * p.width + right, weight * fx * (1 - fy));
            f(y1 * p.width + left, weight * (1 - fx) * fy);
            f(y1 * p.width + right, weight * fx * fy);
        }
    }
}

ITEM3D_HOST_DEVICE inline void equirectangular_forward(const EquirectangularParameters& p,
                                                       std::int64_t index) {
    float sum[3] = {0, 0, 0};
    for_each_equirectangular_tap(p, index, [&](int texel, float weight) {
        for (int c = 0; c < 3; ++c)
            sum[c] += weight * p.map[3 * texel + c];
    });
    for (int c = 0; c < 3; ++c)
        p.cube[3 * index + c] = sum[c];
}

ITEM3D_HOST_DEVICE inline void equirectangular_backward(const EquirectangularParameters& p,
                                                        std::int64_t index) {
    for_each_equirectangular_tap(p, index, [&](int texel, float weight) {
        for (int c = 0; c < 3; ++c)
            p.map_gradient.add(3 * texel + c, weight * p.cube_gradient[3 * index + c]);
    });
}

}  // namespace item3d::kernels
