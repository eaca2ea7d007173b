// The kernels of group_norm.h on plain memory (Wu and He 2018, "Group Normalization"). Let m be the
// mean and 1 / r the standard deviation of a group of channels, and w the weight of a channel. The
// channel's scale is a = w r and its offset is b = bias - m a:
//
//     t = a x + b        y = f(t)        f: SiLU, t / (1 + e^-t), or none
//
// The backward pass, with g = dy f'(t), h = (x - m) r, and means over the group's numbers:
//
//     dx = r (w g - mean(w g) - h mean(w g h)) = a g + constant + slope x
//     slope = -r^2 mean(a g (x - m)) and constant = -mean(a g) - slope m
//
// The means follow from the sums of g and of g (x - m) for each channel (docs/kernels.md).
//
//     maps  [pixels, channels]:  c0 c1 c2 .. of pixel 0 | c0 c1 c2 .. of pixel 1 | ..
//
// The number of channels is a multiple of register_numbers. The arrays scale, offset, shift, sum
// and the like have one number for each channel.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

template <typename Number>
struct NormKernel {
    /// Adds x - shift to sum, and its square to square, by channel. A shift near the mean avoids
    /// cancellation in the variance.
    void (*add_channel_sums)(const Number* x, std::int64_t pixels, std::int64_t channels,
                             const float* shift, double* sum, double* square);
    /// Computes y = f(scale x + offset), where f is SiLU if `silu`, else the identity.
    void (*apply)(const Number* x, std::int64_t pixels, std::int64_t channels, const float* scale,
                  const float* offset, bool silu, Number* y);
    /// Adds g = dy f'(scale x + offset) to sum, and g (x - shift) to product, by channel.
    void (*add_gradient_sums)(const Number* x, const Number* dy, std::int64_t pixels,
                              std::int64_t channels, const float* scale, const float* offset,
                              const float* shift, bool silu, double* sum, double* product);
    /// Computes dx = scale g + constant + slope x.
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
