// Sparse gradients of tables, with entries only for rows that were read.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the sparse gradient with unique rows in rising order, marked as coalesced. LibTorch's
/// accumulation of CPU tensors keeps that order but drops the mark. A gradient whose rows are still
/// in order is therefore only marked, not sorted.
at::Tensor coalesce_rows(const at::Tensor& gradient);

}  // namespace item3d
