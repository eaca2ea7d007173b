// The library's convolution, with a gradient that has the same bytes for any number of threads.
#pragma once

#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>

namespace item3d {

/// convolution(x). With frozen weights on the CPU its backward pass, which goes to x alone, keeps
/// no activations; and for small maps (128 x 128) the gradient does not depend on the number of
/// threads.
at::Tensor rowwise_convolution(torch::nn::Conv2d& convolution, const at::Tensor& x);

}  // namespace item3d
