// The table of the neural texture's kernels in libitem3d_cuda.so (item3d/render/cuda/table.h has
// the rules).
#pragma once

#include "item3d/field/kernels/adam.h"
#include "item3d/field/kernels/bounded.h"
#include "item3d/field/kernels/hash_grid.h"
#include "item3d/render/cuda/table.h"

namespace item3d::cuda {

/// Kernels of the hash grid, compiled for each number of features F of an entry. The launches'
/// count is levels * points for hash_grid and hash_grid_table_backward, and the number of points
/// for hash_grid_points_backward.
#define ITEM3D_HASH_GRID_KERNELS(X)                                                              \
    X(hash_grid, HashGridParameters, item3d::hash_grid_forward<F>(p, i), "hash_grid_encode")     \
    X(hash_grid_points_backward, HashGridParameters, item3d::hash_grid_points_backward<F>(p, i), \
      "hash_grid_points_backward")                                                               \
    X(hash_grid_table_backward, HashGridParameters, item3d::hash_grid_table_backward<F>(p, i),   \
      "hash_grid_table_backward")

/// Kernels of Adam and of the output activation. The launches' count is the number of the
/// gradient's rows for adam_step, and the number of values for the activation.
#define ITEM3D_PLAIN_KERNELS(X)                                             \
    X(adam_step, AdamParameters, adam_step_row(p, i), "adam_step")          \
    X(bounded, BoundedParameters, item3d::bounded_forward(p, i), "bounded") \
    X(bounded_backward, BoundedParameters, item3d::bounded_backward(p, i), "bounded backward")

/// All kernels, in the order of FieldTable.
#define ITEM3D_FIELD_KERNELS(X) \
    ITEM3D_HASH_GRID_KERNELS(X) \
    ITEM3D_PLAIN_KERNELS(X)

struct FieldTable {
    TableHeader header;
    ITEM3D_FIELD_KERNELS(ITEM3D_KERNEL_MEMBER)
};

/// Exported as item3d_cuda_field.
using FieldTableFunction = const FieldTable*();

}  // namespace item3d::cuda
