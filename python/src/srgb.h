// The sRGB transfer function (IEC 61966-2-1) of float32 tensors of any shape.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// Returns linear values of encoded ones.
Tensor srgb_to_linear(const Tensor& encoded);

/// Returns the gradient by the encoded values.
Tensor srgb_to_linear_backward(const Tensor& encoded, const Tensor& gradient);

/// Returns encoded values of linear ones.
Tensor linear_to_srgb(const Tensor& linear);

/// Returns the gradient by the linear values.
Tensor linear_to_srgb_backward(const Tensor& linear, const Tensor& gradient);

}  // namespace item3d::python
