// The sRGB transfer function (IEC 61966-2-1) of float32 tensors of any shape.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Returns the linear values of encoded values.
Tensor srgb_to_linear(const Tensor& encoded);

/// Returns the gradient with respect to the encoded values.
Tensor srgb_to_linear_backward(const Tensor& encoded, const Tensor& gradient);

/// Returns the encoded values of linear values.
Tensor linear_to_srgb(const Tensor& linear);

/// Returns the gradient with respect to the linear values.
Tensor linear_to_srgb_backward(const Tensor& linear, const Tensor& gradient);

}  // namespace item3d::python
