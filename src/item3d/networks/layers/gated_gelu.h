// GEGLU's gate (Shazeer 2020, "GLU Variants Improve Transformer"), in one pass over the memory.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// x [..., 2 C], values and gates side by side -> values gelu(gates), [..., C]. Differentiable;
/// keeps x alone for that.
at::Tensor gated_gelu(const at::Tensor& x);

}  // namespace item3d
