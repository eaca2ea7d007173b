// The kernel that converts weights from the types and orders of files.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

/// Conversion to Number: float, BrainFloat or HalfFloat.
template <typename Number>
struct WeightKernel {
    /// Reorders [rows, in, 3, 3] of files to [rows, 3, 3, in]; in is a multiple of 16.
    template <typename Stored>
    using OrderTaps = void(const Stored* weights, std::int64_t rows, std::int64_t in_channels,
                           Number* ordered);
    OrderTaps<float>* order_floats;
    OrderTaps<BrainFloat>* order_brain_floats;
    OrderTaps<HalfFloat>* order_halves;
    /// Rounds to nearest.
    void (*convert_halves)(const HalfFloat* from, std::int64_t count, Number* to);
};

template <Instructions instructions, typename Number>
WeightKernel<Number> weight_kernel();
template <>
WeightKernel<float> weight_kernel<Instructions::avx2, float>();
template <>
WeightKernel<HalfFloat> weight_kernel<Instructions::avx2, HalfFloat>();
template <>
WeightKernel<float> weight_kernel<Instructions::avx512, float>();
template <>
WeightKernel<HalfFloat> weight_kernel<Instructions::avx512, HalfFloat>();
template <>
WeightKernel<BrainFloat> weight_kernel<Instructions::avx512, BrainFloat>();

}  // namespace item3d
