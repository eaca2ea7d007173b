// The kernel, on plain memory, of products of rows with a matrix that does not change:
//
//     y[r][o] = f(sum_k x[r][k] weights[o][k] + bias[o]) + added[r][o]
//
// r is a row, o a column, k runs along the depth, and f is none, gelu or quick_gelu
// (LinearActivation). Weights are packed once, so that the numbers that one instruction multiplies
// lie side by side (matrix_tile.h):
//
//     weights  [columns, depth]              packed  [columns / 64, depth / group, 64, group]
//
//     k k k k k ..  of column 0              column  0    1    2  ..  63  |  0   1 ..
//     k k k k k ..  of column 1              group   k k  k k  k k        |  k + 2 ..
//
// The last block of 64 columns may be narrower, but has whole registers of 16. Its padding is zero.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/linear_activation.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

namespace item3d {

/// Returns the number of numbers in a packed matrix [columns, depth], whose last 16 columns are
/// padded.
inline std::int64_t packed_size(std::int64_t columns, std::int64_t depth) {
    return whole_registers(columns) * depth;
}

/// A range of rows, and of columns that begins at a multiple of 64.
struct MatrixPart {
    std::int64_t first_row, last_row, first_column, last_column;
};

/// The end of a product: f(product + bias) + added.
struct ProductEnd {
    const float* bias = nullptr;  ///< [columns] or null
    LinearActivation activation = LinearActivation::none;
    const float* added = nullptr;  ///< [rows, columns] or null
};

template <typename Weight>
struct LinearKernel {
    /// Packs the columns [first, last) of weights [columns, depth] into their places in `packed`,
    /// [columns / 64, depth / group, 64, group]. The last block of columns may be narrower, but has
    /// whole registers of 16. `group` is the number of numbers along the depth that one instruction
    /// multiplies (2 for BFloat16, 1 for the other types). first is a multiple of 64. last is a
    /// multiple of 64 or the number of columns. depth is a multiple of 16.
    void (*pack)(const Weight* weights, std::int64_t depth, std::int64_t first, std::int64_t last,
                 Weight* packed);
    /// Computes y [rows, columns] from the product of x [rows, depth] and the transposed weights,
    /// for one part. The sums are float.
    void (*multiply)(const Multiplied<Weight>* x, std::int64_t depth, const Weight* packed,
                     const ProductEnd& end, std::int64_t columns, const MatrixPart& part, float* y);
    /// Does the same, and rounds y to the type of x.
    void (*multiply_rounded)(const Multiplied<Weight>* x, std::int64_t depth, const Weight* packed,
                             const ProductEnd& end, std::int64_t columns, const MatrixPart& part,
                             Multiplied<Weight>* y);
};

template <InstructionSet instructions, typename Weight>
LinearKernel<Weight> linear_kernel();
template <>
LinearKernel<float> linear_kernel<InstructionSet::avx2, float>();
template <>
LinearKernel<Float16> linear_kernel<InstructionSet::avx2, Float16>();
template <>
LinearKernel<float> linear_kernel<InstructionSet::avx512, float>();
template <>
LinearKernel<Float16> linear_kernel<InstructionSet::avx512, Float16>();
template <>
LinearKernel<BFloat16> linear_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
