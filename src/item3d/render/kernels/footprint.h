// Footprints: changes of UV coordinates between adjacent pixels, by the quotient rule.
//
//     uv(x, y) = sum_i e_i uv_i / sum_i e_i        e_i = a_i x + b_i y + c_i (raster.h)
//     d uv / d x = (sum_i a_i uv_i - uv sum_i a_i) / sum_i e_i
//
// These are normalized device coordinates, in which a step of one pixel is 2 / width to the right
// and -2 / height down.
//
//     footprint  [P, 4]:  du/dx dv/dx | du/dy dv/dy        a pixel to the right, then one down
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/render/kernels/raster.h"

#include <cstdint>

namespace item3d::kernels {

struct FootprintParameters {
    const float* positions_clip;    ///< [N, V, 4]
    const std::int32_t* triangles;  ///< [T, 3]
    const float* uvs;               ///< [V, 2]
    const std::int32_t* triangle;   ///< [N, H, W]
    const std::int64_t* pixel;      ///< [P]
    std::int64_t vertices;          ///< V
    int width;
    int height;
    float* footprint;  ///< [P, 4] d(u, v) for one pixel to the right, then for one down
};

/// Computes the footprint of a covered pixel from the edge functions e_i, which are linear on the
/// image plane.
ITEM3D_HOST_DEVICE inline void uv_footprint(const FootprintParameters& p, std::int64_t index) {
    const std::int64_t pixel = p.pixel[index];
    const std::int64_t in_view = pixel % (static_cast<std::int64_t>(p.width) * p.height);
    const std::int64_t view = pixel / (static_cast<std::int64_t>(p.width) * p.height);
    const std::int32_t* corners = p.triangles + 3 * static_cast<std::int64_t>(p.triangle[pixel]);
    const float* clip = p.positions_clip + 4 * p.vertices * view;
    float* out = p.footprint + 4 * index;
    TriangleEdges edges;
    if (!edges.set(clip + 4 * static_cast<std::int64_t>(corners[0]),
                   clip + 4 * static_cast<std::int64_t>(corners[1]),
                   clip + 4 * static_cast<std::int64_t>(corners[2]))) {
        out[0] = out[1] = out[2] = out[3] = 0;
        return;
    }
    const double x = (static_cast<double>(in_view % p.width) + 0.5) * 2 / p.width - 1;
    const double y = 1 - (static_cast<double>(in_view / p.width) + 0.5) * 2 / p.height;
    double sum = 0, by_x = 0, by_y = 0, value[2] = {0, 0}, slope_x[2] = {0, 0}, slope_y[2] = {0, 0};
    for (int i = 0; i < 3; ++i) {
        const double e = edges.a[i] * x + edges.b[i] * y + edges.c[i];
        sum += e;
        by_x += edges.a[i];
        by_y += edges.b[i];
        for (int c = 0; c < 2; ++c) {
            const double uv = p.uvs[2 * static_cast<std::int64_t>(corners[i]) + c];
            value[c] += e * uv;
            slope_x[c] += edges.a[i] * uv;
            slope_y[c] += edges.b[i] * uv;
        }
    }
    const double inverse = sum > 0 ? 1 / sum : 0.0;
    for (int c = 0; c < 2; ++c) {
        const double uv = value[c] * inverse;
        out[c] = static_cast<float>((slope_x[c] - uv * by_x) * inverse * 2 / p.width);
        out[2 + c] = static_cast<float>(-(slope_y[c] - uv * by_y) * inverse * 2 / p.height);
    }
}

}  // namespace item3d::kernels
