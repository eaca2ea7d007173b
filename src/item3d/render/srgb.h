// The sRGB transfer function, for tensors of any shape.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Differentiable conversions of float32 tensors. The gradient of linear_to_srgb is bounded near 0.
/// The result does not depend on the number of threads.
at::Tensor linear_to_srgb(const at::Tensor& linear);
at::Tensor srgb_to_linear(const at::Tensor& encoded);

}  // namespace item3d
