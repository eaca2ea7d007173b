// The kernels of gated_gelu.h on plain memory. Rows are [2 width], values followed by gates; width
// is a multiple of 16.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

template <typename Number>
struct GateKernel {
    /// y [rows, width] = value gelu(gate), for x [rows, 2 width].
    void (*apply)(const Number* x, std::int64_t rows, std::int64_t width, Number* y);
    /// dx [rows, 2 width] from dy [rows, width].
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
