// The neural texture's kernels on CUDA devices.
#pragma once

#include "item3d/field/cuda/table.h"
#include "item3d/render/cuda/module.h"

namespace item3d::cuda {

/// The neural texture's entries; throws as find_table does.
inline const FieldTable& field_table() {
    static const auto* const table =
        reinterpret_cast<const FieldTable*>(find_table("item3d_cuda_field", sizeof(FieldTable)));
    return *table;
}

}  // namespace item3d::cuda
