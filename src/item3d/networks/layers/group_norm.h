// Group norm, with SiLU where it follows, in one pass over the map for networks that only run.
#pragma once

#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/normalization.h>

namespace item3d {

/// What follows the norm.
enum class Activation { none, silu };

/// activation(norm(x)), x [N, C, H, W]. Where the norm's weights ask for no gradient, on a CPU with
/// AVX2 or AVX-512 and for channels in multiples of 16, this is a kernel of our own whose backward
/// pass, to x alone, keeps nothing but x; elsewhere it is LibTorch's two operations.
at::Tensor group_norm(torch::nn::GroupNorm& norm, const at::Tensor& x,
                      Activation activation = Activation::none);

}  // namespace item3d
