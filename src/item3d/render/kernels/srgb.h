// The sRGB transfer function (IEC 61966-2-1) and its gradient. They process one value at a time, so
// that the result does not depend on the distribution of values among threads. In a vector
// library's remainder loops it would depend on this.
//
//     linear x, encoded y:  y = 12.92 x                          x <= 0.0031308
//                           y = 1.055 x^(1 / 2.4) - 0.055        above
//
// in and out are [count], of any shape.
#pragma once

#include "item3d/core/host_device.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

struct CurveParameters {
    const float* in;        ///< [count]
    const float* gradient;  ///< [count] with respect to the result; backward kernels only
    float* out;             ///< [count] the result, or the gradient of `in`
};

ITEM3D_HOST_DEVICE inline void linear_to_srgb(const CurveParameters& p, std::int64_t i) {
    const float x = p.in[i];
    p.out[i] = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

/// Writes the gradient. The slope is largest (12.92) in the linear part, so it is bounded near 0.
ITEM3D_HOST_DEVICE inline void linear_to_srgb_backward(const CurveParameters& p, std::int64_t i) {
    const float x = p.in[i];
    const float slope =
        x <= 0.0031308f ? 12.92f : (1.055f / 2.4f) * std::pow(x, 1.0f / 2.4f - 1.0f);
    p.out[i] = p.gradient[i] * slope;
}

ITEM3D_HOST_DEVICE inline void srgb_to_linear(const CurveParameters& p, std::int64_t i) {
    const float x = p.in[i];
    p.out[i] = x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

ITEM3D_HOST_DEVICE inline void srgb_to_linear_backward(const CurveParameters& p, std::int64_t i) {
    const float x = p.in[i];
    const float slope =
        x <= 0.04045f ? 1.0f / 12.92f : (2.4f / 1.055f) * std::pow((x + 0.055f) / 1.055f, 1.4f);
    p.out[i] = p.gradient[i] * slope;
}

}  // namespace item3d::kernels
