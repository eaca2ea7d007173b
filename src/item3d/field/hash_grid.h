// The multi-resolution hash grid as a differentiable operation on tensors.
#pragma once

#include "item3d/field/kernels/hash_grid.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// The levels of one grid, coarsest first. The resolutions grow geometrically.
struct HashGrid {
    int features = 4;  ///< features of each entry: 1, 2, 4 or 8
    std::vector<HashGridLevel> levels;

    /// Makes levels from the base to the finest resolution, both included. Each level has at most
    /// 2^log2_table_size entries.
    static HashGrid make(int levels, int features, int log2_table_size, int base_resolution,
                         int finest_resolution);

    std::int64_t entries() const;  ///< sum over all levels
    int output_width() const { return static_cast<int>(levels.size()) * features; }
};

/// Encodes points [P, 3] float32 in the unit cube with table [grid.entries(), F] float32. Points
/// outside of the cube are clamped to it. Both tensors are on the CPU or on one CUDA device.
/// Returns [P, levels * F], in which the F features of a level are adjacent.
///
/// Differentiable in points and table. The table's gradient is a sparse tensor with the rows of
/// only those entries that the points read, each once, in rising order. An optimisation step reads
/// thousands of a table's million entries. On the CPU, the sums of a level run in the order of the
/// points, so the result does not depend on the threads. On CUDA this holds only if LibTorch's
/// deterministic algorithms are on.
at::Tensor encode(const HashGrid& grid, const at::Tensor& points, const at::Tensor& table);

}  // namespace item3d
