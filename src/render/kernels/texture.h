// Bilinear texture lookups with glTF's wrap modes.
#pragma once

#include "item3d/core/host_device.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

enum class TextureWrap : int { repeat, mirrored_repeat, clamp_to_edge };

struct TextureParameters {
    const float* texture;  ///< [H, W, C]
    const float* uv;       ///< [P, 2], (0, 0) the top left corner
    int height;
    int width;
    int channels;  ///< C
    TextureWrap wrap_u;
    TextureWrap wrap_v;
};

ITEM3D_HOST_DEVICE inline int wrap_texel(int i, int size, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp_to_edge) return i < 0 ? 0 : (i >= size ? size - 1 : i);
    const int period = wrap == TextureWrap::repeat ? size : 2 * size;
    i %= period;
    i = i < 0 ? i + period : i;
    return i < size ? i : period - 1 - i;
}

struct TextureTaps {
    std::int64_t texel[4];
    float weight[4];
};

ITEM3D_HOST_DEVICE inline TextureTaps texture_taps(const TextureParameters& p, std::int64_t index) {
    const auto coordinate = [](float value, int size) {
        // Far outside, floats have no fraction left; and integers must not overflow.
        const float limit = 1e6f;
        value = value == value ? value : 0.0f;
        value = value < -limit ? -limit : (value > limit ? limit : value);
        return static_cast<double>(value) * size - 0.5;
    };
    const double x = coordinate(p.uv[2 * index], p.width);
    const double y = coordinate(p.uv[2 * index + 1], p.height);
    const double floor_x = std::floor(x), floor_y = std::floor(y);
    const float fx = static_cast<float>(x - floor_x), fy = static_cast<float>(y - floor_y);
    const auto wrapped = [](double i, int size, TextureWrap wrap) {
        // Reduced in double first: an integer cannot hold 1e6 repeats of a large texture.
        if (wrap == TextureWrap::clamp_to_edge)
            i = i < -1 ? -1 : (i > size ? size : i);
        else
            i -= std::floor(i / (2.0 * size)) * (2.0 * size);
        return wrap_texel(static_cast<int>(i), size, wrap);
    };
    const int x0 = wrapped(floor_x, p.width, p.wrap_u);
    const int x1 = wrapped(floor_x + 1, p.width, p.wrap_u);
    const int y0 = wrapped(floor_y, p.height, p.wrap_v);
    const int y1 = wrapped(floor_y + 1, p.height, p.wrap_v);
    const std::int64_t row0 = static_cast<std::int64_t>(y0) * p.width;
    const std::int64_t row1 = static_cast<std::int64_t>(y1) * p.width;
    return {{row0 + x0, row0 + x1, row1 + x0, row1 + x1},
            {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

ITEM3D_HOST_DEVICE inline void texture_forward(const TextureParameters& p, std::int64_t index,
                                               float* values) {
    const TextureTaps taps = texture_taps(p, index);
    for (int c = 0; c < p.channels; ++c) {
        float sum = 0;
        for (int k = 0; k < 4; ++k)
            sum += taps.weight[k] * p.texture[taps.texel[k] * p.channels + c];
        values[index * p.channels + c] = sum;
    }
}

/// Not safe for concurrent calls on one buffer.
ITEM3D_HOST_DEVICE inline void texture_backward(const TextureParameters& p, std::int64_t index,
                                                const float* value_gradient,
                                                float* texture_gradient) {
    const TextureTaps taps = texture_taps(p, index);
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < p.channels; ++c)
            texture_gradient[taps.texel[k] * p.channels + c] +=
                taps.weight[k] * value_gradient[index * p.channels + c];
}

}  // namespace item3d::kernels
