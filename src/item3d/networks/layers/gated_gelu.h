// GEGLU's gate (Shazeer 2020, "GLU Variants Improve Transformer"), in one pass over the memory.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns values * gelu(gates), [..., C], for x [..., 2 C] of values and gates concatenated.
/// Differentiable; the backward pass keeps x alone.
at::Tensor gated_gelu(const at::Tensor& x);

}  // namespace item3d
