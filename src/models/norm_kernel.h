// The arithmetic of group_norm.h on plain memory: AVX-512, compiled for it alone
// (src/CMakeLists.txt), so nothing here may be called where norm_kernel_runs() says no. Maps are
// [pixels, channels]; channels are a multiple of norm_lanes; per-channel arrays have one number for
// each channel.
#pragma once

#include "item3d/models/brain_float.h"

#include <cstdint>

namespace item3d {

constexpr std::int64_t norm_lanes = 16;

template <typename Number>
bool norm_kernel_runs();

/// Adds to sum and square, by channel, x - shift and its square. A shift near the mean spares
/// the variance the difference of two large numbers.
template <typename Number>
void add_channel_sums(const Number* x, std::int64_t pixels, std::int64_t channels,
                      const float* shift, double* sum, double* square);

/// y = f(scale x + offset), f being SiLU or nothing.
template <typename Number>
void apply_norm(const Number* x, std::int64_t pixels, std::int64_t channels, const float* scale,
                const float* offset, bool silu, Number* y);

/// With g = dy f'(scale x + offset): adds to sum and product, by channel, g and g (x - shift).
template <typename Number>
void add_gradient_sums(const Number* x, const Number* dy, std::int64_t pixels,
                       std::int64_t channels, const float* scale, const float* offset,
                       const float* shift, bool silu, double* sum, double* product);

/// dx = scale g + constant + slope x.
template <typename Number>
void apply_norm_gradient(const Number* x, const Number* dy, std::int64_t pixels,
                         std::int64_t channels, const float* scale, const float* offset,
                         const float* constant, const float* slope, bool silu, Number* dx);

}  // namespace item3d
