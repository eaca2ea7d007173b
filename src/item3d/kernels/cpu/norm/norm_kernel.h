// The kernels of group_norm.h on plain memory (Wu and He 2018, "Group Normalization"). A group's
// mean m and standard deviation 1 / r, and a channel's weight w and bias, make the channel's scale
// a = w r and offset b = bias - m a:
//
//     t = a x + b        y = f(t)        f: SiLU, t / (1 + e^-t), or none
//
// Backward, with g = dy f'(t), h = (x - m) r, and means over the group's numbers:
//
//     dx = r (w g - mean(w g) - h mean(w g h)) = a g + constant + slope x
//     slope = -r^2 mean(a g (x - m)) and constant = -mean(a g) - slope m
//
// The means follow from the sums of g and of g (x - m) for each channel (docs/kernels.md).
//
//     maps  [pixels, channels]:  c0 c1 c2 .. of pixel 0 | c0 c1 c2 .. of pixel 1 | ..
//
// Channels are a multiple of register_numbers; per-channel arrays have one number for each channel.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

template <typename Number>
struct NormKernel {
    /// Adds x - shift and its square to sum and square, by channel. A shift near the mean avoids
    /// cancellation in the variance.
    void (*add_channel_sums)(const Number* x, std::int64_t pixels, std::int64_t channels,
                             const float* shift, double* sum, double* square);
    /// y = f(scale x + offset), where f is SiLU or the identity.
    void (*apply)(const Number* x, std::int64_t pixels, std::int64_t channels, const float* scale,
                  const float* offset, bool silu, Number* y);
    /// With g = dy f'(scale x + offset): adds g and g (x - shift) to sum and product, by channel.
    void (*add_gradient_sums)(const Number* x, const Number* dy, std::int64_t pixels,
                              std::int64_t channels, const float* scale, const float* offset,
                              const float* shift, bool silu, double* sum, double* product);
    /// dx = scale g + constant + slope x.
    void (*apply_gradient)(const Number* x, const Number* dy, std::int64_t pixels,
                           std::int64_t channels, const float* scale, const float* offset,
                           const float* constant, const float* slope, bool silu, Number* dx);
};

template <InstructionSet instructions, typename Number>
NormKernel<Number> norm_kernel();
template <>
NormKernel<float> norm_kernel<InstructionSet::avx2, float>();
template <>
NormKernel<float> norm_kernel<InstructionSet::avx512, float>();
template <>
NormKernel<BFloat16> norm_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
