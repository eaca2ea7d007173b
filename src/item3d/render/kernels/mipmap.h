// Texture lookups as in graphics hardware: nearest, bilinear, or isotropic trilinear between the
// levels of a mip map, in two dimensions or on a cube.
//
//     J = [[a, b], [c, d]]      d(texel) / d(pixel): a = du/dx width, b = du/dy width, c, d of v
//     q = (a^2 + b^2 + c^2 + d^2) / 2 + sqrt(half^2 + cross^2)      squared longer semi-axis of J
//     half = (a^2 + b^2 - c^2 - d^2) / 2      cross = a c + b d
//     level = log2(q) / 2 + bias
//     value = (1 - f) bilinear(level i) + f bilinear(level i + 1)      i + f = level, clamped
//
// In the backward pass, d level / d q = 1 / (2 ln 2 q) and d q / d a = a + (half a + cross c) /
// sqrt(..); b, c and d are similar. The derivative of the value with respect to f is the difference
// between the values of both levels. The derivative with respect to u is the bilinear slope times
// the level's width. On a cube, CubeSlopes is the Jacobian of texels with respect to the direction.
//
//     levels  [H, W, C], [H / 2, W / 2, C], ..; [6, H, W, C] on cubes; [N, ..] unless shared
//     slopes  [P, 4]: du/dx du/dy dv/dx dv/dy        [P, 6] on cubes, by x, y and z
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"
#include "item3d/render/kernels/cube.h"
#include "item3d/render/kernels/texture.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

enum class MipmapFilter : int { nearest, linear, linear_mipmap_nearest, linear_mipmap_linear };
enum class MipmapBoundary : int {
    wrap,
    clamp,
    zero,  ///< zeros outside of the texture
    cube,
};

struct MipmapParameters {
    /// Levels, each half as large as the previous one; on cubes, [6, H, W, C]. `first` is the
    /// level's index in `texel_gradient`.
    TextureLevel levels[max_texture_levels];
    int level_count;
    /// True for one texture for all views; false for levels [N, ..], with one texture per view.
    bool shared;
    int channels;  ///< C
    MipmapFilter filter;
    MipmapBoundary boundary;
    std::int64_t pixels_per_view;
    const float* uv;  ///< [P, 2]; on cubes directions [P, 3]
    /// [P, 4 or 6] changes by x and y, for each coordinate. If null, level 0 is used.
    const float* slopes;
    const float* bias;            ///< [P] added to the level, or null
    float* values;                ///< [P, C]
    const float* value_gradient;  ///< [P, C]
    float* uv_gradient;           ///< [P, 2 or 3], or null
    float* slope_gradient;        ///< [P, 4 or 6], or null
    float* bias_gradient;         ///< [P], or null

    ITEM3D_HOST_DEVICE bool is_cube() const { return boundary == MipmapBoundary::cube; }
    ITEM3D_HOST_DEVICE std::int64_t texels(int level) const {
        return static_cast<std::int64_t>(is_cube() ? 6 : 1) * levels[level].height *
               levels[level].width;
    }
};

/// Four texels with weights. The index of a texel outside is -1.
struct MipmapTaps {
    std::int64_t texel[4];
    float weight[4];
    float x, y;  ///< fractions towards the right and down
    int corner;  ///< on a cube, the tap whose value is the mean of the other three; or -1
};

/// A lookup position, which all levels share.
struct MipmapPoint {
    bool valid;
    float u, v;      ///< two-dimensional textures only
    CubePoint cube;  ///< cubes only
};

ITEM3D_HOST_DEVICE inline MipmapPoint mipmap_point(const MipmapParameters& p, std::int64_t index) {
    if (!p.is_cube()) return {true, p.uv[2 * index], p.uv[2 * index + 1], {}};
    const Vec3 d(p.uv[3 * index], p.uv[3 * index + 1], p.uv[3 * index + 2]);
    const float x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    // This is also false for NaN.
    const bool finite = x < 1e30f && y < 1e30f && z < 1e30f;
    if (!finite || !(x > 1e-30f || y > 1e-30f || z > 1e-30f)) return {false, 0, 0, {}};
    return {true, 0, 0, cube_point(d)};
}

ITEM3D_HOST_DEVICE inline MipmapTaps mipmap_taps(const MipmapParameters& p,
                                                 const MipmapPoint& point, int level) {
    const TextureLevel& map = p.levels[level];
    MipmapTaps taps{};
    taps.corner = -1;
    if (p.is_cube()) {
        const CubeTaps cube = cube_taps(point.cube, map.width);
        for (int k = 0; k < 4; ++k) {
            taps.texel[k] = cube.texel[k];
            taps.weight[k] = cube.weight[k];
        }
        taps.x = cube.x;
        taps.y = cube.y;
        taps.corner = cube.corner;
        return taps;
    }
    const TextureWrap wrap =
        p.boundary == MipmapBoundary::wrap ? TextureWrap::repeat : TextureWrap::clamp_to_edge;
    const TextureTaps flat = texture_taps(map, point.u, point.v, wrap, wrap);
    for (int k = 0; k < 4; ++k) {
        taps.texel[k] = flat.texel[k];
        taps.weight[k] = flat.weight[k];
    }
    taps.x = flat.x;
    taps.y = flat.y;
    if (p.boundary == MipmapBoundary::zero) {
        const auto first = [](float value, int size) {
            const float limit = 1e6f;
            value = value == value ? value : 0.0f;
            value = value < -limit ? -limit : (value > limit ? limit : value);
            return whole_below(static_cast<double>(value) * size - 0.5);
        };
        const std::int64_t left = first(point.u, map.width), top = first(point.v, map.height);
        for (int k = 0; k < 4; ++k) {
            const std::int64_t x = left + (k & 1), y = top + (k >> 1);
            if (x < 0 || y < 0 || x >= map.width || y >= map.height) taps.texel[k] = -1;
        }
    }
    return taps;
}

/// Returns the single texel that contains the point.
ITEM3D_HOST_DEVICE inline MipmapTaps nearest_mipmap_taps(const MipmapParameters& p,
                                                         const MipmapPoint& point) {
    MipmapTaps taps = mipmap_taps(p, point, 0);
    const int k = (taps.x >= 0.5f ? 1 : 0) + (taps.y >= 0.5f ? 2 : 0);
    // A cube's corner belongs to three texels.
    const std::int64_t texel = taps.texel[k == taps.corner ? k ^ 1 : k];
    taps.corner = -1;
    for (int i = 0; i < 4; ++i) {
        taps.texel[i] = i == 0 ? texel : -1;
        taps.weight[i] = i == 0 ? 1.0f : 0.0f;
    }
    return taps;
}

/// A pixel's footprint in texels of level 0, and the corresponding level.
struct MipmapFootprint {
    float level;       ///< before the bias, not clamped
    float a, b, c, d;  ///< Jacobian [[a, b], [c, d]] by the pixel's x and y
    float squared;     ///< squared length of the longer axis
    float half, cross, spread;
};

ITEM3D_HOST_DEVICE inline MipmapFootprint mipmap_footprint(float a, float b, float c, float d) {
    MipmapFootprint f{0, a, b, c, d, 0, 0, 0, 0};
    const float xx = a * a + b * b, yy = c * c + d * d;
    f.half = 0.5f * (xx - yy);
    f.cross = a * c + b * d;
    f.spread = std::sqrt(f.half * f.half + f.cross * f.cross);
    f.squared = 0.5f * (xx + yy) + f.spread;
    f.level = f.squared > 1e-30f ? 0.5f * std::log2(f.squared) : -50.0f;
    return f;
}

/// Writes the gradients of the level with respect to a, b, c and d.
ITEM3D_HOST_DEVICE inline void mipmap_level_gradient(const MipmapFootprint& f, float gradient,
                                                     float* out) {
    const float scale = f.squared > 1e-30f ? gradient * 0.72134752f / f.squared : 0.0f;
    const float inverse = f.spread > 0 ? 1 / f.spread : 0.0f;
    const float half = f.half * inverse, cross = f.cross * inverse;
    out[0] = scale * (f.a + half * f.a + cross * f.c);
    out[1] = scale * (f.b + half * f.b + cross * f.d);
    out[2] = scale * (f.c - half * f.c + cross * f.a);
    out[3] = scale * (f.d - half * f.d + cross * f.b);
}

/// Rows of the Jacobian d(texel on the face) / d(direction) on a cube.
struct CubeSlopes {
    Vec3 by_s, by_t, normal;
    float inverse;  ///< 1 / component of the direction along the face's normal
};

ITEM3D_HOST_DEVICE inline CubeSlopes cube_slopes(const MipmapParameters& p,
                                                 const CubePoint& point) {
    const CubeFrame frame = cube_frame(point.face);
    const float scale = 0.5f * static_cast<float>(p.levels[0].width) * point.inverse;
    return {scale * (frame.s - point.s * frame.normal), scale * (frame.t - point.t * frame.normal),
            frame.normal, point.inverse};
}

/// The two levels between which a lookup interpolates.
struct MipmapLevels {
    MipmapFootprint footprint;
    int fine;
    float fraction;  ///< weight of fine + 1
    bool moves;      ///< true if the value depends on the level
};

ITEM3D_HOST_DEVICE inline MipmapLevels mipmap_levels(const MipmapParameters& p,
                                                     const MipmapPoint& point, std::int64_t index) {
    MipmapLevels levels{};
    if (p.filter == MipmapFilter::nearest || p.filter == MipmapFilter::linear) return levels;
    float level = 0;
    if (p.slopes != nullptr) {
        if (p.is_cube()) {
            const float* f = p.slopes + 6 * index;
            const CubeSlopes slopes = cube_slopes(p, point.cube);
            const Vec3 by_x(f[0], f[2], f[4]), by_y(f[1], f[3], f[5]);
            levels.footprint =
                mipmap_footprint(glm::dot(slopes.by_s, by_x), glm::dot(slopes.by_s, by_y),
                                 glm::dot(slopes.by_t, by_x), glm::dot(slopes.by_t, by_y));
        } else {
            const float* f = p.slopes + 4 * index;
            const auto width = static_cast<float>(p.levels[0].width);
            const auto height = static_cast<float>(p.levels[0].height);
            levels.footprint =
                mipmap_footprint(f[0] * width, f[1] * width, f[2] * height, f[3] * height);
        }
        level = levels.footprint.level;
    }
    if (p.bias != nullptr) level += p.bias[index];
    const auto last = static_cast<float>(p.level_count - 1);
    if (!(level > 0))
        level = 0;
    else if (!(level < last))
        level = last;
    else
        levels.moves = p.filter == MipmapFilter::linear_mipmap_linear;
    if (p.filter == MipmapFilter::linear_mipmap_nearest) {
        levels.fine = static_cast<int>(level + 0.5f);
        return levels;
    }
    levels.fine = static_cast<int>(level);
    levels.fraction = level - static_cast<float>(levels.fine);
    return levels;
}

/// Returns the offset of a view's texels in a level.
ITEM3D_HOST_DEVICE inline std::int64_t mipmap_offset(const MipmapParameters& p, std::int64_t index,
                                                     int level) {
    return p.shared ? 0 : index / p.pixels_per_view * p.texels(level) * p.channels;
}

ITEM3D_HOST_DEVICE inline void mipmap_forward(const MipmapParameters& p, std::int64_t index) {
    float* out = p.values + p.channels * index;
    for (int c = 0; c < p.channels; ++c)
        out[c] = 0;
    const MipmapPoint point = mipmap_point(p, index);
    if (!point.valid) return;
    const MipmapLevels levels = mipmap_levels(p, point, index);
    for (int i = 0; i < (levels.fraction > 0 ? 2 : 1); ++i) {
        const int level = levels.fine + i;
        const float share = i == 0 ? 1 - levels.fraction : levels.fraction;
        const MipmapTaps taps = p.filter == MipmapFilter::nearest ? nearest_mipmap_taps(p, point)
                                                                  : mipmap_taps(p, point, level);
        const float* texels = p.levels[level].texels + mipmap_offset(p, index, level);
        for (int k = 0; k < 4; ++k) {
            if (taps.texel[k] < 0) continue;
            const float weight = share * taps.weight[k];
            const float* texel = texels + taps.texel[k] * p.channels;
            for (int c = 0; c < p.channels; ++c)
                out[c] += weight * texel[c];
        }
    }
}

/// Dot product of a lookup's value with the gradient, and its changes for one texel to the right
/// and for one texel down.
struct MipmapSlope {
    float value, by_x, by_y;
};

ITEM3D_HOST_DEVICE inline MipmapSlope mipmap_slope(const MipmapParameters& p,
                                                   const MipmapTaps& taps, const float* texels,
                                                   const float* gradient) {
    float at[4] = {0, 0, 0, 0}, total = 0, value = 0;
    for (int k = 0; k < 4; ++k) {
        if (taps.texel[k] < 0 || k == taps.corner) continue;
        const float* texel = texels + taps.texel[k] * p.channels;
        for (int c = 0; c < p.channels; ++c)
            at[k] += gradient[c] * texel[c];
        total += at[k];
        value += taps.weight[k] * at[k];
    }
    if (taps.corner >= 0) at[taps.corner] = total / 3;
    return {value, (1 - taps.y) * (at[1] - at[0]) + taps.y * (at[3] - at[2]),
            (1 - taps.x) * (at[2] - at[0]) + taps.x * (at[3] - at[1])};
}

/// Writes the gradients with respect to a pixel's coordinates, slopes and bias, and adds those with
/// respect to texels.
ITEM3D_HOST_DEVICE inline void mipmap_backward(const MipmapParameters& p, std::int64_t index,
                                               const Accumulator& texel_gradient) {
    const int coordinates = p.is_cube() ? 3 : 2;
    float by_uv[3] = {0, 0, 0}, by_slopes[6] = {0, 0, 0, 0, 0, 0}, by_level = 0;
    const float* gradient = p.value_gradient + p.channels * index;
    const MipmapPoint point = mipmap_point(p, index);
    if (point.valid) {
        const MipmapLevels levels = mipmap_levels(p, point, index);
        const bool nearest = p.filter == MipmapFilter::nearest;
        Vec3 by_direction(0.0f);
        for (int i = 0; i < (levels.moves || levels.fraction > 0 ? 2 : 1); ++i) {
            const int level = levels.fine + i;
            const float share = i == 0 ? 1 - levels.fraction : levels.fraction;
            const MipmapTaps taps =
                nearest ? nearest_mipmap_taps(p, point) : mipmap_taps(p, point, level);
            const TextureLevel& map = p.levels[level];
            const std::int64_t offset = mipmap_offset(p, index, level);
            for (int k = 0; texel_gradient.wanted() && k < 4; ++k)
                for (int c = 0; taps.texel[k] >= 0 && c < p.channels; ++c)
                    texel_gradient.add(map.first + offset + taps.texel[k] * p.channels + c,
                                       share * taps.weight[k] * gradient[c]);
            if (nearest) continue;
            const MipmapSlope slope = mipmap_slope(p, taps, map.texels + offset, gradient);
            by_level += i == 0 ? -slope.value : slope.value;
            if (!p.is_cube()) {
                by_uv[0] += share * slope.by_x * static_cast<float>(map.width);
                by_uv[1] += share * slope.by_y * static_cast<float>(map.height);
                continue;
            }
            const CubeSlopes to_texels = cube_slopes(p, point.cube);
            // The slopes are in texels of level 0.
            const float size =
                static_cast<float>(map.width) / static_cast<float>(p.levels[0].width);
            by_direction +=
                share * size * (slope.by_x * to_texels.by_s + slope.by_y * to_texels.by_t);
        }
        if (!levels.moves) by_level = 0;
        if (by_level != 0 && p.slopes != nullptr) {
            float by_texel[4];
            mipmap_level_gradient(levels.footprint, by_level, by_texel);
            if (p.is_cube()) {
                const CubeSlopes to_texels = cube_slopes(p, point.cube);
                const float* f = p.slopes + 6 * index;
                for (int axis = 0; axis < 2; ++axis) {
                    const Vec3 moved(f[axis], f[2 + axis], f[4 + axis]);
                    const Vec3 by_moved =
                        by_texel[axis] * to_texels.by_s + by_texel[2 + axis] * to_texels.by_t;
                    for (int k = 0; k < 3; ++k)
                        by_slopes[2 * k + axis] = by_moved[k];
                    by_direction -=
                        to_texels.inverse * (glm::dot(to_texels.normal, moved) * by_moved +
                                             glm::dot(by_moved, moved) * to_texels.normal);
                }
            } else {
                const auto width = static_cast<float>(p.levels[0].width);
                const auto height = static_cast<float>(p.levels[0].height);
                for (int k = 0; k < 4; ++k)
                    by_slopes[k] = by_texel[k] * (k < 2 ? width : height);
            }
        }
        for (int k = 0; p.is_cube() && k < 3; ++k)
            by_uv[k] = by_direction[k];
    }
    for (int k = 0; p.uv_gradient != nullptr && k < coordinates; ++k)
        p.uv_gradient[coordinates * index + k] = by_uv[k];
    for (int k = 0; p.slope_gradient != nullptr && k < 2 * coordinates; ++k)
        p.slope_gradient[2 * coordinates * index + k] = by_slopes[k];
    if (p.bias_gradient != nullptr) p.bias_gradient[index] = by_level;
}

}  // namespace item3d::kernels
