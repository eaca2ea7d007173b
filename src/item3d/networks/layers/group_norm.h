// Group norm with optional SiLU, in one pass over the map for networks with frozen weights.
#pragma once

#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/normalization.h>

namespace item3d {

/// Activation after the norm.
enum class Activation { none, silu };

/// Returns activation(norm(x)) for x [N, C, H, W]. A kernel of this project computes it if the
/// norm's weights require no gradient, on a CPU with AVX2 or AVX-512, for channels in multiples of
/// 16. Its backward pass computes the gradient of x alone, and keeps only x. Otherwise LibTorch's
/// two operations compute it.
at::Tensor group_norm(torch::nn::GroupNorm& norm, const at::Tensor& x,
                      Activation activation = Activation::none);

}  // namespace item3d
