// The kernel that converts weights from the types and orders in files.
//
//     file    [rows, in, 3, 3]      c0: t0 t1 .. t8 | c1: t0 t1 .. t8 | ..
//     ordered [rows, 3, 3, in]      t0: c0 c1 c2 .. | t1: c0 c1 c2 .. | ..
//
// t is a tap, counted row by row, and c is an input channel. The pack() functions of the kernels
// take the ordered form.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

/// The conversion to Number, which is float, BFloat16 or Float16.
template <typename Number>
struct WeightKernel {
    /// Reorders weights [rows, in, 3, 3] of a file to [rows, 3, 3, in]. The number of input
    /// channels is a multiple of 16.
    template <typename Stored>
    using OrderTaps = void(const Stored* weights, std::int64_t rows, std::int64_t in_channels,
                           Number* ordered);
    OrderTaps<float>* order_floats;
    OrderTaps<BFloat16>* order_bfloat16;
    OrderTaps<Float16>* order_halves;
    /// Converts numbers, and rounds them to nearest.
    void (*convert_halves)(const Float16* from, std::int64_t count, Number* to);
};

template <InstructionSet instructions, typename Number>
WeightKernel<Number> weight_kernel();
template <>
WeightKernel<float> weight_kernel<InstructionSet::avx2, float>();
template <>
WeightKernel<Float16> weight_kernel<InstructionSet::avx2, Float16>();
template <>
WeightKernel<float> weight_kernel<InstructionSet::avx512, float>();
template <>
WeightKernel<Float16> weight_kernel<InstructionSet::avx512, Float16>();
template <>
WeightKernel<BFloat16> weight_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
