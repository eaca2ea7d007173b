// Coverage of pixel centres by triangles, in homogeneous coordinates (Olano and Greer 1997,
// "Triangle Scan Conversion using 2D Homogeneous Coordinates"). Edge functions come from clip-space
// (x, y, w) without a division, so triangles that cross the near plane need no clipping.
//
//     e_i(x, y) = a_i x + b_i y + c_i = (x, y, 1) . (p_j x p_k)      D = p_0 . (p_1 x p_2) > 0
//     inside:  e_0, e_1, e_2 > 0, or e_i = 0 and the first non-zero number of a_i, b_i, c_i is > 0
//     weight_i = e_i / (e_0 + e_1 + e_2)        1 / w = (e_0 + e_1 + e_2) / D
//     1 - z / w = sum_i e_i (w_i - z_i) / D        near plane: sum_i e_i (z_i + w_i) >= 0
//
// The vertices are p_i = (x_i, y_i, w_i). The weights follow from w (x, y, 1) = sum_i weight_i p_i
// by Cramer's rule, weight_i = w e_i / D. For D < 0 all signs are changed, so that both sides of a
// triangle are drawn.
//
// No pixel of a shared edge is missed or drawn twice. Products of two floats are exact in double,
// so the two triangles compute the same e_i with opposite signs, and a pixel with e_i = 0 belongs
// to exactly one of them.
//
//     barycentrics  [N, H, W, 2]   depth  [N, H, W]   triangle  [N, H, W]      row 0 on top
//     boxes         [N, T] pixels x0 <= x < x1, y0 <= y < y1 of each triangle
//     keys          [N, H, W] of 64 bits: nearness as the bits of a positive float | ~triangle
#pragma once

#include "item3d/core/host_device.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace item3d::kernels {

/// Half-open box of pixels; empty when x0 >= x1 or y0 >= y1.
struct PixelBox {
    std::int16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Quantity that the depth test compares.
enum class DepthOrder : int {
    w,         ///< smaller w is nearer: depth is w, without a far plane
    z_over_w,  ///< smaller z/w is nearer, as in OpenGL: depth is z/w, and z >= w is clipped
};

struct RasterParameters {
    const float* positions_clip;    ///< [N, V, 4]
    const std::int32_t* triangles;  ///< [T, 3]
    PixelBox* boxes;                ///< [N, T]
    std::int64_t vertices;          ///< V
    std::int64_t triangle_count;    ///< T
    int width;
    int height;
    float* barycentrics;     ///< [N, H, W, 2]
    float* depth;            ///< [N, H, W] nearness while rasterizing; 0 without a triangle
    std::int32_t* triangle;  ///< [N, H, W] index of the triangle, or -1
    const float* behind;     ///< [N, H, W] depth that fragments must exceed, or null
    DepthOrder order = DepthOrder::w;
};

/// Builder of the pixel box of points in normalized device coordinates.
struct BoxBuilder {
    float low_x = 1e30f, low_y = 1e30f, high_x = -1e30f, high_y = -1e30f;

    ITEM3D_HOST_DEVICE void add(float x, float y) {
        low_x = x < low_x ? x : low_x;
        high_x = x > high_x ? x : high_x;
        low_y = y < low_y ? y : low_y;
        high_y = y > high_y ? y : high_y;
    }
    /// Returns the box of all pixels whose centre may be inside, with a margin for rounding.
    ITEM3D_HOST_DEVICE PixelBox pixels(int width, int height) const {
        // Margin in pixels. It is above the rounding of projected floats, but small enough to
        // enlarge few boxes.
        constexpr float margin = 4e-3f;
        PixelBox box;
        if (!(low_x <= high_x) || !(low_y <= high_y)) return box;
        const float half_width = 0.5f * width, half_height = 0.5f * height;
        box.x0 = first_above(low_x * half_width + half_width - 0.5f - margin, width);
        box.x1 = first_above(high_x * half_width + half_width - 0.5f + margin, width);
        box.y0 = first_above(half_height - high_y * half_height - 0.5f - margin, height);
        box.y1 = first_above(half_height - low_y * half_height - 0.5f + margin, height);
        return box;
    }

  private:
    /// Returns the smallest integer above `value`, clamped to [0, limit]. Uses conversions instead
    /// of ceil(), which is a function call on old x86-64.
    ITEM3D_HOST_DEVICE static std::int16_t first_above(float value, int limit) {
        if (!(value >= 0)) return 0;
        if (value >= static_cast<float>(limit)) return static_cast<std::int16_t>(limit);
        return static_cast<std::int16_t>(static_cast<int>(value) + 1);
    }
};

/// Sets and returns boxes[view * T + triangle].
ITEM3D_HOST_DEVICE inline PixelBox bound_triangle(const RasterParameters& p, std::int64_t view,
                                                  std::int64_t triangle) {
    const float* clip = p.positions_clip + 4 * p.vertices * view;
    const std::int32_t* corners = p.triangles + 3 * triangle;
    const float* v[3];
    float near_distance[3];
    int in_front = 0;
    bool finite = true, unusual = false;
    BoxBuilder builder;
    for (int i = 0; i < 3; ++i) {
        v[i] = clip + 4 * static_cast<std::int64_t>(corners[i]);
        near_distance[i] = v[i][2] + v[i][3];
        // this is also false for NaN
        finite = finite && std::fabs(v[i][0]) < 1e30f && std::fabs(v[i][1]) < 1e30f &&
                 std::fabs(near_distance[i]) < 1e30f;
        if (near_distance[i] >= 0 && v[i][3] > 0) {
            ++in_front;
            const float inverse_w = 1.0f / v[i][3];
            builder.add(v[i][0] * inverse_w, v[i][1] * inverse_w);
        }
        unusual = unusual || (near_distance[i] >= 0 && !(v[i][3] > 0));
    }
    PixelBox box;
    if (finite && in_front > 0 && unusual) {
        // A vertex is behind the eye, and the near plane does not cut it. No regular camera
        // produces this case.
        box.x1 = static_cast<std::int16_t>(p.width);
        box.y1 = static_cast<std::int16_t>(p.height);
    } else if (finite && in_front > 0) {
        for (int i = 0; in_front < 3 && i < 3; ++i) {
            const int j = i == 2 ? 0 : i + 1;
            if ((near_distance[i] >= 0) != (near_distance[j] >= 0)) {
                const float t = near_distance[i] / (near_distance[i] - near_distance[j]);
                float w = v[i][3] + t * (v[j][3] - v[i][3]);
                w = w > 1e-20f ? w : 1e-20f;
                builder.add((v[i][0] + t * (v[j][0] - v[i][0])) / w,
                            (v[i][1] + t * (v[j][1] - v[i][1])) / w);
            }
        }
        box = builder.pixels(p.width, p.height);
    }
    p.boxes[view * p.triangle_count + triangle] = box;
    return box;
}

/// Edge functions of one triangle, all positive inside.
struct TriangleEdges {
    double a[3], b[3], c[3];  ///< e_i = a x + b y + c in normalized device coordinates
    bool keeps_zero[3];       ///< true if e_i = 0 belongs to this triangle
    double determinant;       ///< positive; 1/w at a pixel = (e_0 + e_1 + e_2) / determinant

    /// Returns false for triangles without area on the screen.
    ITEM3D_HOST_DEVICE bool set(const float* v0, const float* v1, const float* v2) {
        const float* v[3] = {v0, v1, v2};
        for (int i = 0; i < 3; ++i) {
            const float* p = v[(i + 1) % 3];
            const float* q = v[(i + 2) % 3];
            const double px = p[0], py = p[1], pw = p[3], qx = q[0], qy = q[1], qw = q[3];
            a[i] = py * qw - pw * qy;
            b[i] = pw * qx - px * qw;
            c[i] = px * qy - py * qx;
        }
        determinant = a[0] * v0[0] + b[0] * v0[1] + c[0] * v0[3];
        if (!(determinant > 0) && !(determinant < 0)) return false;
        if (determinant < 0) {
            for (int i = 0; i < 3; ++i) {
                a[i] = -a[i];
                b[i] = -b[i];
                c[i] = -c[i];
            }
            determinant = -determinant;
        }
        for (int i = 0; i < 3; ++i)
            keeps_zero[i] = a[i] > 0 || (a[i] == 0 && (b[i] > 0 || (b[i] == 0 && c[i] > 0)));
        return true;
    }
};

/// Calls visit(pixel, nearness, e, sum) for the pixels in rows [row_begin, row_end) whose centre is
/// in one triangle of one view. nearness: 1/w, or 1 - z/w for DepthOrder::z_over_w. e: the three
/// edge functions. sum: their sum.
template <typename Visit>
ITEM3D_HOST_DEVICE inline void for_each_fragment(const RasterParameters& p, std::int64_t view,
                                                 std::int64_t t, int row_begin, int row_end,
                                                 const Visit& visit) {
    const PixelBox box = p.boxes[view * p.triangle_count + t];
    const int y0 = box.y0 > row_begin ? box.y0 : row_begin;
    const int y1 = box.y1 < row_end ? box.y1 : row_end;
    if (y0 >= y1 || box.x0 >= box.x1) return;

    const float* clip = p.positions_clip + 4 * p.vertices * view;
    const std::int32_t* corners = p.triangles + 3 * t;
    const float* v[3];
    for (int i = 0; i < 3; ++i)
        v[i] = clip + 4 * static_cast<std::int64_t>(corners[i]);
    TriangleEdges edges;
    if (!edges.set(v[0], v[1], v[2])) return;

    const bool by_z = p.order == DepthOrder::z_over_w;
    double near_distance[3], far_distance[3];
    bool crosses_near = false;
    float min_w = v[0][3], largest_w = v[0][3];
    for (int i = 0; i < 3; ++i) {
        near_distance[i] = static_cast<double>(v[i][2]) + v[i][3];
        far_distance[i] = static_cast<double>(v[i][3]) - v[i][2];
        crosses_near = crosses_near || near_distance[i] < 0 || v[i][3] <= 0;
        min_w = v[i][3] < min_w ? v[i][3] : min_w;
        largest_w = v[i][3] > largest_w ? v[i][3] : largest_w;
    }

    // Divisions are deferred to the first fragment, because most triangles of a dense mesh have no
    // fragment.
    double inverse_determinant = 0, low_nearness = 0, high_nearness = 0;
    const double step_x = 2.0 / p.width, step_y = 2.0 / p.height;
    // For narrow boxes testing each centre is less work than the three divisions of a row.
    const bool wide = box.x1 - box.x0 > 8;
    for (int y = y0; y < y1; ++y) {
        const double ndc_y = 1.0 - (y + 0.5) * step_y;
        double row[3];
        int x0 = box.x0, x1 = box.x1;
        for (int i = 0; i < 3; ++i) {
            row[i] = edges.b[i] * ndc_y + edges.c[i];
            // Skips to the sign change of the edge function, with one pixel of slack for rounding.
            if (wide && edges.a[i] != 0) {
                const double crossing = (1.0 - row[i] / edges.a[i]) * 0.5 * p.width - 0.5;
                if (edges.a[i] > 0) {
                    if (crossing > x1)
                        x0 = x1;
                    else if (crossing - 1 > x0)
                        x0 = static_cast<int>(crossing - 1);
                } else {
                    if (crossing < x0 - 1)
                        x1 = x0;
                    else if (crossing + 2 < x1)
                        x1 = static_cast<int>(crossing + 2);
                }
            }
        }
        const std::int64_t row_pixel = (view * p.height + y) * p.width;
        for (int x = x0; x < x1; ++x) {
            const double ndc_x = (x + 0.5) * step_x - 1.0;
            double e[3];
            bool inside = true;
            for (int i = 0; i < 3; ++i) {
                e[i] = edges.a[i] * ndc_x + row[i];
                inside = inside && (e[i] > 0 || (e[i] == 0 && edges.keeps_zero[i]));
            }
            if (!inside) continue;
            const double sum = e[0] + e[1] + e[2];
            if (!(sum > 0)) continue;
            if (inverse_determinant == 0) {
                inverse_determinant = 1.0 / edges.determinant;
                low_nearness = 1.0 / largest_w;
                high_nearness = 1.0 / min_w;
                if (by_z) {
                    low_nearness = high_nearness = far_distance[0] / v[0][3];
                    for (int i = 1; i < 3; ++i) {
                        const double nearness = far_distance[i] / v[i][3];
                        low_nearness = nearness < low_nearness ? nearness : low_nearness;
                        high_nearness = nearness > high_nearness ? nearness : high_nearness;
                    }
                }
            }
            double nearness =
                (by_z ? e[0] * far_distance[0] + e[1] * far_distance[1] + e[2] * far_distance[2]
                      : sum) *
                inverse_determinant;
            if (crosses_near) {
                if (e[0] * near_distance[0] + e[1] * near_distance[1] + e[2] * near_distance[2] < 0)
                    continue;
            } else {
                // Rounding must not push slivers in front of everything else.
                nearness = nearness < low_nearness ? low_nearness : nearness;
                nearness = nearness > high_nearness ? high_nearness : nearness;
            }
            visit(row_pixel + x, static_cast<float>(nearness), e, sum);
        }
    }
}

/// Returns the depth of a fragment or covered pixel.
ITEM3D_HOST_DEVICE inline float depth_of(const RasterParameters& p, float nearness) {
    return p.order == DepthOrder::z_over_w ? 1.0f - nearness : 1.0f / nearness;
}

/// True if a fragment is beyond the `behind` depth of its pixel.
ITEM3D_HOST_DEVICE inline bool passes_behind(const RasterParameters& p, std::int64_t pixel,
                                             float nearness) {
    if (p.order == DepthOrder::z_over_w)
        return p.behind == nullptr || depth_of(p, nearness) > p.behind[pixel];
    // The margin keeps a fragment from counting as beyond its own depth.
    return p.behind == nullptr || !(nearness * p.behind[pixel] > 1 - 1e-6f);
}

/// True if a triangle whose box is one pixel is completely behind that pixel's fragment. Most
/// triangles of a dense mesh are that small, and half of them are hidden.
ITEM3D_HOST_DEVICE inline bool hidden_in_one_pixel(const RasterParameters& p, std::int64_t view,
                                                   std::int64_t t) {
    const PixelBox box = p.boxes[view * p.triangle_count + t];
    if (box.x1 - box.x0 != 1 || box.y1 - box.y0 != 1 || p.order != DepthOrder::w) return false;
    const float nearness = p.depth[(view * p.height + box.y0) * p.width + box.x0];
    if (!(nearness > 0)) return false;
    const float* clip = p.positions_clip + 4 * p.vertices * view;
    for (int i = 0; i < 3; ++i)
        if (!(clip[4 * static_cast<std::int64_t>(p.triangles[3 * t + i]) + 3] * nearness >
              1 + 1e-6f))
            return false;
    return true;
}

/// Draws one triangle of one view into rows [row_begin, row_end). For each pixel, triangles must be
/// drawn in ascending order, because at equal depth the first triangle stays.
ITEM3D_HOST_DEVICE inline void rasterize_triangle(const RasterParameters& p, std::int64_t view,
                                                  std::int64_t t, int row_begin, int row_end) {
    if (hidden_in_one_pixel(p, view, t)) return;
    for_each_fragment(p, view, t, row_begin, row_end,
                      [&](std::int64_t pixel, float nearness, const double* e, double sum) {
                          if (!(nearness > p.depth[pixel])) return;
                          if (!passes_behind(p, pixel, nearness)) return;
                          p.depth[pixel] = nearness;
                          p.triangle[pixel] = static_cast<std::int32_t>(t);
                          p.barycentrics[2 * pixel] = static_cast<float>(e[0] / sum);
                          p.barycentrics[2 * pixel + 1] = static_cast<float>(e[1] / sum);
                      });
}

/// Converts the nearness that rasterize_triangle() stored to depth.
ITEM3D_HOST_DEVICE inline void finish_depth(const RasterParameters& p, std::int64_t pixel) {
    if (p.depth[pixel] > 0) p.depth[pixel] = depth_of(p, p.depth[pixel]);
}

/// Parameters for threads that draw triangles in any order. The largest key of a pixel is that of
/// its nearest fragment and, at equal depth, that of the first triangle.
struct KeyedRasterParameters {
    RasterParameters raster;
    unsigned long long* keys;  ///< [N, H, W], zeros initially: bits of nearness, then of ~triangle
    std::int64_t views;        ///< N
    std::int64_t bands;        ///< bands of rows; a thread draws into one
};

/// Returns KeyedRasterParameters::bands. If there are few triangles, more bands spread each
/// triangle over more threads. triangles: number of triangles of all views.
inline std::int64_t key_bands(std::int64_t triangles, int height) {
    constexpr std::int64_t enough_threads = 1 << 20;
    const std::int64_t bands = enough_threads / (triangles > 1 ? triangles : 1);
    return bands < 1 ? 1 : (bands < height ? bands : height);
}

/// Draws one triangle of one view into one band of rows. index: (band * N + view) * T + triangle.
ITEM3D_HOST_DEVICE inline void rasterize_keys(const KeyedRasterParameters& p, std::int64_t index) {
    const std::int64_t t = index % p.raster.triangle_count;
    const std::int64_t view = index / p.raster.triangle_count % p.views;
    const std::int64_t band = index / p.raster.triangle_count / p.views;
    const int row_begin = static_cast<int>(p.raster.height * band / p.bands);
    const int row_end = static_cast<int>(p.raster.height * (band + 1) / p.bands);
    for_each_fragment(
        p.raster, view, t, row_begin, row_end,
        [&](std::int64_t pixel, float nearness, const double*, double) {
            if (!(nearness > 0) || !passes_behind(p.raster, pixel, nearness)) return;
            const unsigned long long key =
                static_cast<unsigned long long>(std::bit_cast<std::uint32_t>(nearness)) << 32 |
                (0xffffffffu - static_cast<std::uint32_t>(t));
#if defined(__CUDA_ARCH__)
            if (key > p.keys[pixel]) atomicMax(p.keys + pixel, key);
#else
            if (key > p.keys[pixel]) p.keys[pixel] = key;
#endif
        });
}

/// Writes the outputs of a pixel from its key.
ITEM3D_HOST_DEVICE inline void resolve_key(const KeyedRasterParameters& keyed, std::int64_t pixel) {
    const RasterParameters& p = keyed.raster;
    const unsigned long long key = keyed.keys[pixel];
    if (key == 0) {
        p.depth[pixel] = p.barycentrics[2 * pixel] = p.barycentrics[2 * pixel + 1] = 0;
        p.triangle[pixel] = -1;
        return;
    }
    const std::int32_t t = static_cast<std::int32_t>(0xffffffffu - static_cast<std::uint32_t>(key));
    const std::int64_t per_view = static_cast<std::int64_t>(p.width) * p.height;
    const float* clip = p.positions_clip + 4 * p.vertices * (pixel / per_view);
    const std::int32_t* corners = p.triangles + 3 * static_cast<std::int64_t>(t);
    TriangleEdges edges;
    edges.set(clip + 4 * static_cast<std::int64_t>(corners[0]),
              clip + 4 * static_cast<std::int64_t>(corners[1]),
              clip + 4 * static_cast<std::int64_t>(corners[2]));
    const int x = static_cast<int>(pixel % p.width);
    const int y = static_cast<int>(pixel % per_view / p.width);
    const double ndc_x = (x + 0.5) * (2.0 / p.width) - 1.0;
    const double ndc_y = 1.0 - (y + 0.5) * (2.0 / p.height);
    double e[3];
    for (int i = 0; i < 3; ++i)
        e[i] = edges.a[i] * ndc_x + (edges.b[i] * ndc_y + edges.c[i]);
    const double sum = e[0] + e[1] + e[2];
    p.depth[pixel] = depth_of(p, std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)));
    p.triangle[pixel] = t;
    p.barycentrics[2 * pixel] = static_cast<float>(e[0] / sum);
    p.barycentrics[2 * pixel + 1] = static_cast<float>(e[1] / sum);
}

}  // namespace item3d::kernels
