// Group norm with optional SiLU, in one pass over the map for networks with frozen weights.
#pragma once

#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/normalization.h>

namespace item3d {

/// Activation after the norm.
enum class Activation { none, silu };

/// Returns activation(norm(x)), x [N, C, H, W]. If the norm's weights require no gradient, on a CPU
/// with AVX2 or AVX-512 and for channels in multiples of 16, this is a kernel of our own whose
/// backward pass, for x alone, keeps only x; else LibTorch's two operations.
at::Tensor group_norm(torch::nn::GroupNorm& norm, const at::Tensor& x,
                      Activation activation = Activation::none);

}  // namespace item3d
