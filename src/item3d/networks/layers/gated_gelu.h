// GEGLU's gate (Shazeer 2020, "GLU Variants Improve Transformer"), in one pass over the memory.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns values * gelu(gates), [..., C], for x [..., 2 C], which is values and gates
/// concatenated. Differentiable; only x is kept for the backward pass.
at::Tensor gated_gelu(const at::Tensor& x);

}  // namespace item3d
