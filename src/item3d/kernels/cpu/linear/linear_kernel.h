// Products of rows with a frozen matrix on plain memory.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/linear_activation.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

namespace item3d {

/// Numbers of a packed matrix [columns, depth]: its last 16 columns may be fewer, and are filled
/// up.
inline std::int64_t packed_size(std::int64_t columns, std::int64_t depth) {
    return whole_registers(columns) * depth;
}

/// Rows, and columns beginning at a multiple of 64.
struct MatrixPart {
    std::int64_t first_row, last_row, first_column, last_column;
};

/// What becomes of a product: f(product + bias) + added.
struct ProductEnd {
    const float* bias = nullptr;  ///< [columns] or null
    LinearActivation activation = LinearActivation::none;
    const float* added = nullptr;  ///< [rows, columns] or null
};

template <typename Weight>
struct LinearKernel {
    /// weights [columns, depth] -> [columns / 64, depth / group, 64, group], the last of them as
    /// narrow as whole registers of 16 allow; a group being the numbers of depth that one
    /// instruction multiplies (2 of BrainFloat, 1 of the others). For columns [first, last), first
    /// being a multiple of 64, and last too or the end. depth: a multiple of 16.
    void (*pack)(const Weight* weights, std::int64_t depth, std::int64_t first, std::int64_t last,
                 Weight* packed);
    /// y [rows, columns] of the product x [rows, depth] weights^T, for one part; sums in float.
    void (*multiply)(const Multiplied<Weight>* x, std::int64_t depth, const Weight* packed,
                     const ProductEnd& end, std::int64_t columns, const MatrixPart& part, float* y);
    /// The same, rounded to what the weights are multiplied by.
    void (*multiply_rounded)(const Multiplied<Weight>* x, std::int64_t depth, const Weight* packed,
                             const ProductEnd& end, std::int64_t columns, const MatrixPart& part,
                             Multiplied<Weight>* y);
};

template <Instructions instructions, typename Weight>
LinearKernel<Weight> linear_kernel();
template <>
LinearKernel<float> linear_kernel<Instructions::avx2, float>();
template <>
LinearKernel<HalfFloat> linear_kernel<Instructions::avx2, HalfFloat>();
template <>
LinearKernel<float> linear_kernel<Instructions::avx512, float>();
template <>
LinearKernel<HalfFloat> linear_kernel<Instructions::avx512, HalfFloat>();
template <>
LinearKernel<BrainFloat> linear_kernel<Instructions::avx512, BrainFloat>();

}  // namespace item3d
