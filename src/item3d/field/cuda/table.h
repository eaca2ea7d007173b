// What libitem3d_cuda.so offers to the neural texture (item3d/render/cuda/table.h has the rules).
#pragma once

#include "item3d/field/kernels/adam.h"
#include "item3d/field/kernels/hash_grid.h"
#include "item3d/render/cuda/table.h"

namespace item3d::cuda {

struct FieldTable {
    TableHeader header;
    Kernel<HashGridParameters> hash_grid;                  ///< count: levels * points
    Kernel<HashGridParameters> hash_grid_points_backward;  ///< count: points
    Kernel<HashGridParameters> hash_grid_table_backward;   ///< count: levels * points
    Kernel<AdamParameters> adam_step;                      ///< count: rows of the gradient
};

/// Exported as item3d_cuda_field.
using FieldTableFunction = const FieldTable*();

}  // namespace item3d::cuda
