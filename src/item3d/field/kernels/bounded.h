// The output activation of the neural texture. It is a sigmoid that overshoots a range and is
// clamped to the range.
//
//     s = 1 / (1 + e^-x)        span = high - low        o = sigmoid_overshoot
//     out = clamp(low - o span + s (1 + 2 o) span, low, high)
//     gradient = (1 + 2 o) span s (1 - s)
//
//     in, out  [rows, width], any number of rows        low, high  [width]
//
// The gradient ignores the clamp, so that values can leave the ends of the range.
#pragma once

#include "item3d/core/host_device.h"

#include <cmath>
#include <cstdint>

namespace item3d {

/// Overshoot of the sigmoid beyond each end of the range, before the clamp, in parts of the span.
/// Black and white then lie on the slope of the sigmoid instead of at its infinite ends, so an edit
/// can change them. A larger overshoot would clamp more values.
inline constexpr float sigmoid_overshoot = 0.05f;

struct BoundedParameters {
    const float* in;    ///< [count] numbers, in rows of `width`
    const float* low;   ///< [width]
    const float* high;  ///< [width]
    /// [count] gradient with respect to the result; only for the backward kernel.
    const float* gradient;
    std::int64_t width;
    float* out;  ///< [count] the result, or the gradient of `in`
};

ITEM3D_HOST_DEVICE inline void bounded_forward(const BoundedParameters& p, std::int64_t i) {
    const float low = p.low[i % p.width], high = p.high[i % p.width];
    const float span = high - low;
    const float sigmoid = 1.0f / (1.0f + std::exp(-p.in[i]));
    const float wide =
        low - sigmoid_overshoot * span + sigmoid * ((1.0f + 2.0f * sigmoid_overshoot) * span);
    p.out[i] = wide < low ? low : wide > high ? high : wide;
}

/// Computes the gradient, which passes through the clamp.
ITEM3D_HOST_DEVICE inline void bounded_backward(const BoundedParameters& p, std::int64_t i) {
    const float span = p.high[i % p.width] - p.low[i % p.width];
    const float sigmoid = 1.0f / (1.0f + std::exp(-p.in[i]));
    p.out[i] =
        p.gradient[i] * ((1.0f + 2.0f * sigmoid_overshoot) * span) * (1.0f - sigmoid) * sigmoid;
}

}  // namespace item3d
