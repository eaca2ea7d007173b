// The kernels of gated_gelu.h on plain memory. They compute GEGLU (Shazeer 2020, "GLU Variants
// Improve Transformer") of values a and gates b, and its gradients:
//
//     y = a gelu(b)        gelu(b) = b Phi(b)
//
//     da = dy gelu(b)        db = dy a (Phi(b) + b phi(b))
//
// Phi and phi are the distribution function and the density of a standard normal variable.
//
//     x, dx  [rows, 2 width]:  a_0 a_1 ... | b_0 b_1 ...        y, dy  [rows, width]
//
// width is a multiple of 16.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

template <typename Number>
struct GateKernel {
    /// Computes y [rows, width] from x [rows, 2 width].
    void (*apply)(const Number* x, std::int64_t rows, std::int64_t width, Number* y);
    /// Computes dx [rows, 2 width] from dy [rows, width].
    void (*apply_gradient)(const Number* x, const Number* dy, std::int64_t rows, std::int64_t width,
                           Number* dx);
};

template <InstructionSet instructions, typename Number>
GateKernel<Number> gate_kernel();
template <>
GateKernel<float> gate_kernel<InstructionSet::avx2, float>();
template <>
GateKernel<float> gate_kernel<InstructionSet::avx512, float>();
template <>
GateKernel<BFloat16> gate_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
