// The multi-resolution hash grid as a differentiable operation on tensors.
#pragma once

#include "item3d/field/kernels/hash_grid.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Levels of one grid, coarsest first; resolutions grow geometrically.
struct HashGrid {
    int features = 4;  ///< number for each entry: 1, 2, 4 or 8
    std::vector<HashGridLevel> levels;

    /// Makes levels from base to finest resolution (both included), of at most 2^log2_table_size
    /// entries each.
    static HashGrid make(int levels, int features, int log2_table_size, int base_resolution,
                         int finest_resolution);

    std::int64_t entries() const;  ///< sum over all levels
    int output_width() const { return static_cast<int>(levels.size()) * features; }
};

/// Encodes points [P, 3] float32 in the unit cube (others are clamped to it) with table
/// [grid.entries(), F] float32. Returns [P, levels * F], level-major. Both on the CPU or on one
/// CUDA device.
///
/// Differentiable in points and table. The table's gradient is a sparse tensor (unique rows in
/// rising order) of only the entries that the points read: an optimisation step reads thousands of
/// a table's million entries. On the CPU, sums run in the order of the points within a level, so
/// the result does not depend on threads; on CUDA only with LibTorch's deterministic algorithms.
at::Tensor encode(const HashGrid& grid, const at::Tensor& points, const at::Tensor& table);

}  // namespace item3d
