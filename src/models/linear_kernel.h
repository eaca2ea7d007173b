// Products of rows with a frozen matrix on plain memory: AVX-512, compiled for it alone
// (src/CMakeLists.txt), so nothing here may be called where matrix_kernel_runs() says no.
#pragma once

#include "item3d/models/linear_activation.h"
#include "item3d/models/matrix_kernel.h"

namespace item3d {

/// Numbers of a packed matrix [columns, depth]; its columns are filled up to whole ones of 64.
inline std::int64_t packed_size(std::int64_t columns, std::int64_t depth) {
    return (columns + packed_columns - 1) / packed_columns * packed_columns * depth;
}

/// weights [columns, depth] -> [columns / 64, depth / group, 64, group], a group being the numbers
/// of depth that one instruction multiplies (2 of BrainFloat, 1 of the others); for columns [first,
/// last), first being a multiple of 64. depth: a multiple of 16.
template <typename Weight>
void pack_columns(const Weight* weights, std::int64_t depth, std::int64_t first, std::int64_t last,
                  Weight* packed);

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

/// y [rows, columns] of the product x [rows, depth] weights^T, for one part; sums in float. Result:
/// float or Weight.
template <typename Weight, typename Result>
void multiply_part(const Multiplied<Weight>* x, std::int64_t depth, const Weight* packed,
                   const ProductEnd& end, std::int64_t columns, const MatrixPart& part, Result* y);

}  // namespace item3d
