// Gradients of tables of which few rows were looked up.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// The sparse gradient with unique rows in rising order, marked as coalesced. Accumulation of CPU
/// tensors keeps that order and drops the mark, so the rows themselves are looked at before they
/// are sorted again.
at::Tensor coalesce_rows(const at::Tensor& gradient);

}  // namespace item3d
