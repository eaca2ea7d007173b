// Texture lookups with glTF's wrap modes. They are bilinear, nearest, or anisotropic, that is,
// trilinear along the longer axis of a pixel's footprint.
//
//     x = u W - 1/2, y = v H - 1/2        texel i covers i / W to (i + 1) / W
//     fx, fy: fractional parts of x, y
//     value = (1 - fx) (1 - fy) t_00 + fx (1 - fy) t_10 + (1 - fx) fy t_01 + fx fy t_11
//     d value / d u = W ((1 - fy) (t_10 - t_00) + fy (t_11 - t_01))
//
// The footprint is an ellipse with the semi-axes `major` and `minor` in texels. They are the
// singular values of the Jacobian J of texels with respect to pixels, that is, the square roots of
// the eigenvalues of J J^T, which are mean +- spread.
//
//     probes = ceil(major / minor), at most 8        level = log2(minor), minor at least major / 8
//     value = mean over the probes of the trilinear value at level
//
//       . . . . . . . . . . .           x: a probe. They lie along the longer axis, major / probes
//     .   x     x     x     x   .       texels apart, centred on the pixel. The axis has half the
//       . . . . . . . . . . .           angle of the vector (half, xy), with J J^T = [[xx, xy],
//                                       [xy, yy]] and half = (xx - yy) / 2
//
//     levels     [H, W, C], each half of the one before
//     footprint  [P, 4]: du/dx dv/dx du/dy dv/dy
#pragma once

#include "item3d/core/accumulate.h"
#include "item3d/core/host_device.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

enum class TextureWrap : int { repeat, mirrored_repeat, clamp_to_edge };

inline constexpr int max_texture_levels = 16;
/// Maximum ratio of the axes of an ellipse that is filtered without blur. It trades the number of
/// lookups for sharpness at grazing angles.
inline constexpr int max_texture_probes = 8;

struct TextureLevel {
    const float* texels;  ///< [H, W, C]
    int height;
    int width;
    std::int64_t first;  ///< index of this level's gradient
};

struct TextureParameters {
    TextureLevel levels[max_texture_levels];  ///< each half as large as the previous one
    int level_count;
    int channels;     ///< C
    const float* uv;  ///< [P, 2], (0, 0) the top left corner
    /// [P, 4] the change of (u, v) over a step of one pixel in x, then over one in y. If it is
    /// null, only level 0 is sampled.
    const float* footprint;
    TextureWrap wrap_u;
    TextureWrap wrap_v;
    bool nearest;  ///< unfiltered level-0 texels where they are at least as large as a pixel
};

ITEM3D_HOST_DEVICE inline int wrap_texel(int i, int size, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp_to_edge) return i < 0 ? 0 : (i >= size ? size - 1 : i);
    const int period = wrap == TextureWrap::repeat ? size : 2 * size;
    i %= period;
    i = i < 0 ? i + period : i;
    return i < size ? i : period - 1 - i;
}

struct TextureTaps {
    std::int64_t texel[4];  ///< upper left, upper right, lower left, lower right
    float weight[4];
    float x, y;  ///< fractions towards the right and down
};

/// Returns floor(value), for |value| far below 2^63. Old x86-64 has no instruction for floor().
ITEM3D_HOST_DEVICE inline std::int64_t whole_below(double value) {
    const auto whole = static_cast<std::int64_t>(value);
    return whole - (value < static_cast<double>(whole) ? 1 : 0);
}

ITEM3D_HOST_DEVICE inline TextureTaps texture_taps(const TextureLevel& level, float u, float v,
                                                   TextureWrap wrap_u, TextureWrap wrap_v) {
    const auto coordinate = [](float value, int size) {
        // Far outside, floats have no fraction. Integers must not overflow either.
        const float limit = 1e6f;
        value = value == value ? value : 0.0f;
        value = value < -limit ? -limit : (value > limit ? limit : value);
        return static_cast<double>(value) * size - 0.5;
    };
    const double x = coordinate(u, level.width), y = coordinate(v, level.height);
    const std::int64_t left = whole_below(x), top = whole_below(y);
    const float fx = static_cast<float>(x - static_cast<double>(left));
    const float fy = static_cast<float>(y - static_cast<double>(top));
    const auto wrapped = [](std::int64_t i, int size, TextureWrap wrap) {
        if (i >= 0 && i < size) return static_cast<int>(i);
        // Reduces in 64 bits first, because 32 bits cannot hold 1e6 repeats of a large texture.
        if (wrap == TextureWrap::clamp_to_edge)
            i = i < -1 ? -1 : (i > size ? size : i);
        else
            i %= 2 * static_cast<std::int64_t>(size);
        return wrap_texel(static_cast<int>(i), size, wrap);
    };
    const int x0 = wrapped(left, level.width, wrap_u);
    const int x1 = wrapped(left + 1, level.width, wrap_u);
    const int y0 = wrapped(top, level.height, wrap_v);
    const int y1 = wrapped(top + 1, level.height, wrap_v);
    const std::int64_t row0 = static_cast<std::int64_t>(y0) * level.width;
    const std::int64_t row1 = static_cast<std::int64_t>(y1) * level.width;
    return {{row0 + x0, row0 + x1, row1 + x0, row1 + x1},
            {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy},
            fx,
            fy};
}

/// Anisotropic filter of a pixel's footprint. It has probes along the footprint's longer axis; each
/// interpolates between two levels.
struct TextureFilter {
    int probes;
    float step_u, step_v;  ///< UV step between probes
    int level;
    float fraction;  ///< weight of level + 1
};

ITEM3D_HOST_DEVICE inline TextureFilter texture_filter(const TextureParameters& p,
                                                       std::int64_t index) {
    const TextureFilter sharp{1, 0, 0, 0, 0};
    if (p.footprint == nullptr) return sharp;
    const float* f = p.footprint + 4 * index;
    const auto width = static_cast<float>(p.levels[0].width);
    const auto height = static_cast<float>(p.levels[0].height);
    // Columns of the Jacobian in texels; its singular values are the ellipse's semi-axes.
    const float ax = f[0] * width, ay = f[1] * height, bx = f[2] * width, by = f[3] * height;
    const float xx = ax * ax + bx * bx, yy = ay * ay + by * by, xy = ax * ay + bx * by;
    const float mean = 0.5f * (xx + yy), half = 0.5f * (xx - yy);
    const float spread = std::sqrt(half * half + xy * xy);
    if (!(mean + spread > 1) || !(mean + spread < 1e12f)) return sharp;
    const float major = std::sqrt(mean + spread);
    float minor = std::sqrt(mean > spread ? mean - spread : 0.0f);
    minor = minor > 1 ? minor : 1.0f;
    const float minimum = major / max_texture_probes;
    minor = minor > minimum ? minor : minimum;
    TextureFilter filter = sharp;
    filter.probes = static_cast<int>(std::ceil(major / minor - 1e-3f));
    filter.probes = filter.probes < 1 ? 1 : filter.probes;
    if (filter.probes > 1) {
        // The longer axis lies at half the angle whose cosine is half / spread.
        const float cosine = half / spread;
        const float along = std::sqrt(0.5f * (cosine > -1 ? 1 + cosine : 0.0f));
        const float across = std::sqrt(0.5f * (cosine < 1 ? 1 - cosine : 0.0f));
        const float step = major / static_cast<float>(filter.probes);
        filter.step_u = step * along / width;
        filter.step_v = step * (xy < 0 ? -across : across) / height;
    }
    float level = std::log2(minor);
    const auto last = static_cast<float>(p.level_count - 1);
    level = level < last ? level : last;
    filter.level = static_cast<int>(level);
    filter.fraction = level - static_cast<float>(filter.level);
    return filter;
}

/// Returns the single texel that contains the point.
ITEM3D_HOST_DEVICE inline TextureTaps nearest_taps(const TextureParameters& p, std::int64_t index) {
    TextureTaps taps =
        texture_taps(p.levels[0], p.uv[2 * index], p.uv[2 * index + 1], p.wrap_u, p.wrap_v);
    const int k = (taps.x >= 0.5f ? 1 : 0) + (taps.y >= 0.5f ? 2 : 0);
    const std::int64_t texel = taps.texel[k];
    for (int i = 0; i < 4; ++i) {
        taps.texel[i] = texel;
        taps.weight[i] = i == 0 ? 1.0f : 0.0f;
    }
    return taps;
}

/// Calls f(level, taps, weight) for each bilinear lookup of the weighted sum.
template <typename F>
ITEM3D_HOST_DEVICE inline void for_each_lookup(const TextureParameters& p, std::int64_t index,
                                               const F& f) {
    const TextureFilter filter = texture_filter(p, index);
    if (p.nearest && filter.level == 0 && filter.fraction == 0 && filter.probes == 1) {
        f(p.levels[0], nearest_taps(p, index), 1.0f);
        return;
    }
    const float share = 1 / static_cast<float>(filter.probes);
    for (int probe = 0; probe < filter.probes; ++probe) {
        const float along =
            static_cast<float>(probe) - 0.5f * static_cast<float>(filter.probes - 1);
        const float u = p.uv[2 * index] + along * filter.step_u;
        const float v = p.uv[2 * index + 1] + along * filter.step_v;
        const TextureLevel& fine = p.levels[filter.level];
        f(fine, texture_taps(fine, u, v, p.wrap_u, p.wrap_v), (1 - filter.fraction) * share);
        if (filter.fraction > 0) {
            const TextureLevel& coarse = p.levels[filter.level + 1];
            f(coarse, texture_taps(coarse, u, v, p.wrap_u, p.wrap_v), filter.fraction * share);
        }
    }
}

/// Computes the weighted sum. Channels: number of channels if it is known at compile time,
/// otherwise 0.
template <int Channels>
ITEM3D_HOST_DEVICE inline void texture_sum(const TextureParameters& p, std::int64_t index,
                                           float* values) {
    const int channels = Channels > 0 ? Channels : p.channels;
    float* out = values + index * channels;
    for (int c = 0; c < channels; ++c)
        out[c] = 0;
    for_each_lookup(p, index, [&](const TextureLevel& level, const TextureTaps& taps, float share) {
        for (int c = 0; c < channels; ++c) {
            float sum = 0;
            for (int k = 0; k < 4; ++k)
                sum += taps.weight[k] * level.texels[taps.texel[k] * channels + c];
            out[c] += share * sum;
        }
    });
}

ITEM3D_HOST_DEVICE inline void texture_forward(const TextureParameters& p, std::int64_t index,
                                               float* values) {
    switch (p.channels) {
        case 3:
            return texture_sum<3>(p, index, values);
        case 4:
            return texture_sum<4>(p, index, values);
        default:
            return texture_sum<0>(p, index, values);
    }
}

/// Parameters of the conversion of slopes (mipmap.h) to footprints.
struct SlopeParameters {
    const float* slopes;  ///< [P, 4] du/dx du/dy dv/dx dv/dy
    float* footprint;     ///< [P, 4] du/dx dv/dx du/dy dv/dy
};

/// Writes one value of a footprint. index: 4 * point + axis.
ITEM3D_HOST_DEVICE inline void slopes_to_footprint(const SlopeParameters& p, std::int64_t index) {
    const std::int64_t axis = index % 4;
    p.footprint[index] = p.slopes[index - axis + (axis == 1 ? 2 : (axis == 2 ? 1 : axis))];
}

/// Parameters of halving: texels of the next level are means of 2 x 2.
struct HalveParameters {
    /// The fine level [2H, 2W, C]; backward, the coarse level's gradient [H, W, C].
    const float* in;
    int fine_width;  ///< 2W
    int channels;    ///< C
    float* out;      ///< the coarse level; backward: the fine one's gradient
};

/// Computes one texel of the coarse level. index: y * W + x of this texel.
ITEM3D_HOST_DEVICE inline void halve_texture(const HalveParameters& p, std::int64_t index) {
    const int channels = p.channels;
    const std::int64_t width = p.fine_width / 2, y = index / width, x = index % width;
    const float* above = p.in + (2 * y * p.fine_width + 2 * x) * channels;
    const float* below = above + static_cast<std::int64_t>(p.fine_width) * channels;
    float* out = p.out + index * channels;
    for (int c = 0; c < channels; ++c)
        out[c] = 0.25f * ((above[c] + above[c + channels]) + (below[c] + below[c + channels]));
}

/// Writes the gradient of the four texels whose mean is coarse texel `index`.
ITEM3D_HOST_DEVICE inline void halve_texture_backward(const HalveParameters& p,
                                                      std::int64_t index) {
    const int channels = p.channels;
    const std::int64_t width = p.fine_width / 2, y = index / width, x = index % width;
    float* above = p.out + (2 * y * p.fine_width + 2 * x) * channels;
    float* below = above + static_cast<std::int64_t>(p.fine_width) * channels;
    const float* in = p.in + index * channels;
    for (int c = 0; c < channels; ++c)
        above[c] = above[c + channels] = below[c] = below[c + channels] = 0.25f * in[c];
}

/// Adds one lookup's gradient to the levels' gradients, which begin at the offsets `first`.
ITEM3D_HOST_DEVICE inline void texture_backward(const TextureParameters& p, std::int64_t index,
                                                const float* value_gradient,
                                                const Accumulator& texel_gradient) {
    const float* gradient = value_gradient + index * p.channels;
    for_each_lookup(p, index, [&](const TextureLevel& level, const TextureTaps& taps, float share) {
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < p.channels; ++c)
                texel_gradient.add(level.first + taps.texel[k] * p.channels + c,
                                   share * taps.weight[k] * gradient[c]);
    });
}

/// Writes uv_gradient [P, 2], with the footprint as a constant.
ITEM3D_HOST_DEVICE inline void texture_uv_backward(const TextureParameters& p, std::int64_t index,
                                                   const float* value_gradient,
                                                   float* uv_gradient) {
    const float* gradient = value_gradient + index * p.channels;
    float by_u = 0, by_v = 0;
    for_each_lookup(p, index, [&](const TextureLevel& level, const TextureTaps& taps, float share) {
        const auto at = [&](int k, int c) { return level.texels[taps.texel[k] * p.channels + c]; };
        for (int c = 0; c < p.channels; ++c) {
            const float right =
                (1 - taps.y) * (at(1, c) - at(0, c)) + taps.y * (at(3, c) - at(2, c));
            const float down =
                (1 - taps.x) * (at(2, c) - at(0, c)) + taps.x * (at(3, c) - at(1, c));
            by_u += share * gradient[c] * right * static_cast<float>(level.width);
            by_v += share * gradient[c] * down * static_cast<float>(level.height);
        }
    });
    uv_gradient[2 * index] = by_u;
    uv_gradient[2 * index + 1] = by_v;
}

}  // namespace item3d::kernels
