// Access to the neural texture's kernels on CUDA devices.
#pragma once

#include "item3d/field/cuda/table.h"
#include "item3d/render/cuda/module.h"

namespace item3d::cuda {

/// Returns the neural texture's kernels. Throws as find_table().
inline const FieldTable& field_table() {
    static const auto* const table =
        reinterpret_cast<const FieldTable*>(find_table("item3d_cuda_field", sizeof(FieldTable)));
    return *table;
}

}  // namespace item3d::cuda
