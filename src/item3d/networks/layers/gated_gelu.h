// GEGLU's gate (Shazeer 2020, "GLU Variants Improve Transformer"), in one pass over the memory.
#pragma once

#include <torch/types.h>

namespace item3d {

/// x [..., 2 C], values and gates side by side -> values gelu(gates), [..., C]. Differentiable;
/// keeps x alone for that.
torch::Tensor gated_gelu(const torch::Tensor& x);

}  // namespace item3d
