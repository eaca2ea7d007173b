// LibTorch's convolution with a gradient that does not depend on the number of threads.
#pragma once

#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>

namespace item3d {

/// Returns convolution(x). With frozen weights on the CPU its backward pass, for x alone, keeps no
/// activations, and the gradient of small maps (up to 128 x 128 pixels) does not depend on the
/// number of threads.
at::Tensor rowwise_convolution(torch::nn::Conv2d& convolution, const at::Tensor& x);

}  // namespace item3d
