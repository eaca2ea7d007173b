// Rasters of four floats per pixel, as published renderers exchange them. The floats are the
// weights of a triangle's vertices 0 and 1, the depth, and the triangle's index + 1 (0: none).
// Attributes and gradients are computed for every pixel, without a list of covered ones.
//
//     value = b_0 a_0 + b_1 a_1 + (1 - b_0 - b_1) a_2
//     d value / d x = (d b_0 / d x) (a_0 - a_2) + (d b_1 / d x) (a_1 - a_2)
//
// The slopes d b / d x are from barycentrics.h. Both formulas are linear in each argument. If g,
// g_x and g_y are the gradients with respect to the value and its slopes, the gradient is
//
//     with respect to b_0             g (a_0 - a_2)
//     with respect to d b_0 / d x     g_x (a_0 - a_2)
//     with respect to a_0             g b_0 + g_x d b_0 / d x + g_y d b_0 / d y
//
//     raster  [N, H, W, 4]:  b_0 b_1 depth id      slopes  [N, H, W, 4]:  b_0 by x, y; b_1 by x, y
//     values  [N, H, W, A]        value_slopes  [N, H, W, 2 D]:  x and y of each sloped channel
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/render/kernels/barycentrics.h"

#include <cstdint>

namespace item3d::kernels {

/// Largest number of triangles whose index + 1 is exact in float32.
inline constexpr std::int64_t max_float_triangles = (1 << 24) - 1;

/// Returns the index of the triangle at a pixel of a raster [.., 4], or -1.
ITEM3D_HOST_DEVICE inline std::int64_t triangle_at(const float* raster, std::int64_t pixel) {
    const float id = raster[4 * pixel + 3];
    return id >= 1 && id <= static_cast<float>(max_float_triangles)
               ? static_cast<std::int64_t>(id) - 1
               : -1;
}

/// View and coordinates of a pixel of N images.
struct PixelPlace {
    std::int64_t view;
    int x, y;

    ITEM3D_HOST_DEVICE PixelPlace(std::int64_t pixel, int width, int height) {
        const std::int64_t per_view = static_cast<std::int64_t>(width) * height;
        view = pixel / per_view;
        y = static_cast<int>(pixel % per_view / width);
        x = static_cast<int>(pixel % width);
    }
};

/// Parameters of the conversion of rasters with an array for each quantity (raster.h) to rasters of
/// four floats.
struct PackParameters {
    const float* barycentrics;     ///< [N, H, W, 2]
    const float* depth;            ///< [N, H, W]
    const std::int32_t* triangle;  ///< [N, H, W]
    const std::int32_t* first;     ///< [N, 2] the first triangle of each view, its count; or null
    std::int64_t pixels_per_view;  ///< H W
    float* raster;                 ///< [N, H, W, 4]
};

ITEM3D_HOST_DEVICE inline void pack_raster(const PackParameters& p, std::int64_t pixel) {
    float* out = p.raster + 4 * pixel;
    const std::int32_t t = p.triangle[pixel];
    if (t < 0) {
        out[0] = out[1] = out[2] = out[3] = 0;
        return;
    }
    const std::int32_t first = p.first == nullptr ? 0 : p.first[2 * (pixel / p.pixels_per_view)];
    out[0] = p.barycentrics[2 * pixel];
    out[1] = p.barycentrics[2 * pixel + 1];
    out[2] = p.depth[pixel];
    out[3] = static_cast<float>(first + t + 1);
}

/// Parameters of the inverse conversion.
struct UnpackParameters {
    const float* raster;     ///< [N, H, W, 4]
    std::int32_t* triangle;  ///< [N, H, W]
    float* depth;            ///< [N, H, W]
};

ITEM3D_HOST_DEVICE inline void unpack_raster(const UnpackParameters& p, std::int64_t pixel) {
    p.triangle[pixel] = static_cast<std::int32_t>(triangle_at(p.raster, pixel));
    p.depth[pixel] = p.raster[4 * pixel + 2];
}

struct RasterSlopeParameters {
    const float* positions_clip;    ///< [N, V, 4], or [V, 4]
    std::int64_t view_stride;       ///< floats between the positions of two views: 4 V, or 0
    const std::int32_t* triangles;  ///< [T, 3]
    const float* raster;            ///< [N, H, W, 4]
    int width;
    int height;
    float* slopes;  ///< [N, H, W, 4] db0/dx, db0/dy, db1/dx, db1/dy; a pixel down: +y
    const float* raster_gradient;  ///< [N, H, W, 4]
    const float* slope_gradient;   ///< [N, H, W, 4], or null
};

ITEM3D_HOST_DEVICE inline void raster_slopes(const RasterSlopeParameters& p, std::int64_t pixel) {
    float* out = p.slopes + 4 * pixel;
    const std::int64_t t = triangle_at(p.raster, pixel);
    if (t < 0) {
        out[0] = out[1] = out[2] = out[3] = 0;
        return;
    }
    const PixelPlace place(pixel, p.width, p.height);
    const ClipTriangle triangle(p.positions_clip + p.view_stride * place.view, p.triangles + 3 * t);
    const WeightSlopes slopes =
        weight_slopes(triangle, pixel_centre(place.x, place.y, p.width, p.height),
                      p.raster + 4 * pixel, p.width, p.height);
    for (int k = 0; k < 2; ++k) {
        out[2 * k] = static_cast<float>(slopes.by_x[k]);
        out[2 * k + 1] = static_cast<float>(slopes.by_y[k]);
    }
}

/// Adds one pixel's gradients with respect to the clip-space vertices. Depth and index have none.
ITEM3D_HOST_DEVICE inline void raster_backward(const RasterSlopeParameters& p, std::int64_t pixel,
                                               const Accumulator& clip_gradient) {
    const std::int64_t t = triangle_at(p.raster, pixel);
    if (t < 0) return;
    const float* gradient = p.raster_gradient + 4 * pixel;
    const double by_weight[3] = {gradient[0], gradient[1], 0};
    WeightSlopes by_slope{};
    bool slopes = false;
    for (int k = 0; p.slope_gradient != nullptr && k < 2; ++k) {
        by_slope.by_x[k] = p.slope_gradient[4 * pixel + 2 * k];
        by_slope.by_y[k] = p.slope_gradient[4 * pixel + 2 * k + 1];
        slopes = slopes || by_slope.by_x[k] != 0 || by_slope.by_y[k] != 0;
    }
    if (by_weight[0] == 0 && by_weight[1] == 0 && !slopes) return;
    const float b0 = p.raster[4 * pixel], b1 = p.raster[4 * pixel + 1];
    const float weights[3] = {b0, b1, 1.0f - b0 - b1};
    const PixelPlace place(pixel, p.width, p.height);
    const std::int32_t* corners = p.triangles + 3 * t;
    DVec3 by_vertex[3];
    if (!weights_backward(ClipTriangle(p.positions_clip + p.view_stride * place.view, corners),
                          pixel_centre(place.x, place.y, p.width, p.height), weights, by_weight,
                          slopes ? &by_slope : nullptr, p.width, p.height, by_vertex))
        return;
    for (int k = 0; k < 3; ++k) {
        const std::int64_t row =
            p.view_stride * place.view + 4 * static_cast<std::int64_t>(corners[k]);
        clip_gradient.add(row, static_cast<float>(by_vertex[k].x));
        clip_gradient.add(row + 1, static_cast<float>(by_vertex[k].y));
        clip_gradient.add(row + 3, static_cast<float>(by_vertex[k].z));
    }
}

struct PixelAttributeParameters {
    const float* attributes;            ///< [N, V, A], or [V, A]
    std::int64_t view_stride;           ///< V A, or 0
    std::int64_t pixels_per_view;       ///< H W
    int channels;                       ///< A
    const std::int32_t* triangles;      ///< [T, 3]
    const float* raster;                ///< [N, H, W, 4]
    const float* slopes;                ///< [N, H, W, 4] of raster_slopes(), or null
    const std::int64_t* sloped;         ///< [D] channels with slopes
    int sloped_count;                   ///< D, 0 without slopes
    float* values;                      ///< [N, H, W, A]
    float* value_slopes;                ///< [N, H, W, 2 D] in x and y, channel after channel
    const float* value_gradient;        ///< [N, H, W, A]
    const float* value_slope_gradient;  ///< [N, H, W, 2 D]
    float* raster_gradient;             ///< [N, H, W, 4], or null
    float* slope_gradient;              ///< [N, H, W, 4], or null
};

ITEM3D_HOST_DEVICE inline void pixel_attributes(const PixelAttributeParameters& p,
                                                std::int64_t pixel) {
    float* out = p.values + p.channels * pixel;
    float* out_slopes = p.value_slopes + 2 * p.sloped_count * pixel;
    const std::int64_t t = triangle_at(p.raster, pixel);
    if (t < 0) {
        for (int c = 0; c < p.channels; ++c)
            out[c] = 0;
        for (int c = 0; c < 2 * p.sloped_count; ++c)
            out_slopes[c] = 0;
        return;
    }
    const float b0 = p.raster[4 * pixel], b1 = p.raster[4 * pixel + 1];
    const float weights[3] = {b0, b1, 1.0f - b0 - b1};
    const float* corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = p.attributes + p.view_stride * (pixel / p.pixels_per_view) +
                    p.channels * static_cast<std::int64_t>(p.triangles[3 * t + k]);
    for (int c = 0; c < p.channels; ++c)
        out[c] = weights[0] * corner[0][c] + weights[1] * corner[1][c] + weights[2] * corner[2][c];
    for (int i = 0; i < p.sloped_count; ++i) {
        const std::int64_t c = p.sloped[i];
        const float* slopes = p.slopes + 4 * pixel;
        const float first = corner[0][c] - corner[2][c], second = corner[1][c] - corner[2][c];
        out_slopes[2 * i] = slopes[0] * first + slopes[2] * second;
        out_slopes[2 * i + 1] = slopes[1] * first + slopes[3] * second;
    }
}

/// Writes the gradients of one pixel with respect to raster and slopes, and adds those with respect
/// to attributes.
ITEM3D_HOST_DEVICE inline void pixel_attributes_backward(const PixelAttributeParameters& p,
                                                         std::int64_t pixel,
                                                         const Accumulator& attribute_gradient) {
    float by_raster[4] = {0, 0, 0, 0}, by_slopes[4] = {0, 0, 0, 0};
    const std::int64_t t = triangle_at(p.raster, pixel);
    if (t >= 0) {
        const float b0 = p.raster[4 * pixel], b1 = p.raster[4 * pixel + 1];
        const float weights[3] = {b0, b1, 1.0f - b0 - b1};
        const float* gradient = p.value_gradient + p.channels * pixel;
        std::int64_t row[3];
        for (int k = 0; k < 3; ++k)
            row[k] = p.view_stride * (pixel / p.pixels_per_view) +
                     p.channels * static_cast<std::int64_t>(p.triangles[3 * t + k]);
        for (int c = 0; c < p.channels; ++c) {
            const float last = p.attributes[row[2] + c];
            by_raster[0] += gradient[c] * (p.attributes[row[0] + c] - last);
            by_raster[1] += gradient[c] * (p.attributes[row[1] + c] - last);
            for (int k = 0; attribute_gradient.wanted() && k < 3; ++k)
                attribute_gradient.add(row[k] + c, weights[k] * gradient[c]);
        }
        for (int i = 0; i < p.sloped_count; ++i) {
            const std::int64_t c = p.sloped[i];
            const float* slopes = p.slopes + 4 * pixel;
            const float* g = p.value_slope_gradient + 2 * (p.sloped_count * pixel + i);
            const float last = p.attributes[row[2] + c];
            const float first = p.attributes[row[0] + c] - last;
            const float second = p.attributes[row[1] + c] - last;
            by_slopes[0] += g[0] * first;
            by_slopes[1] += g[1] * first;
            by_slopes[2] += g[0] * second;
            by_slopes[3] += g[1] * second;
            if (!attribute_gradient.wanted()) continue;
            const float by_first = g[0] * slopes[0] + g[1] * slopes[1];
            const float by_second = g[0] * slopes[2] + g[1] * slopes[3];
            attribute_gradient.add(row[0] + c, by_first);
            attribute_gradient.add(row[1] + c, by_second);
            attribute_gradient.add(row[2] + c, -by_first - by_second);
        }
    }
    for (int c = 0; c < 4; ++c) {
        if (p.raster_gradient != nullptr) p.raster_gradient[4 * pixel + c] = by_raster[c];
        if (p.slope_gradient != nullptr) p.slope_gradient[4 * pixel + c] = by_slopes[c];
    }
}

}  // namespace item3d::kernels
