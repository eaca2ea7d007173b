// Images to tensors and back, and their transfer functions.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Both differentiable; the gradient of linear_to_srgb is bounded near 0.
at::Tensor linear_to_srgb(const at::Tensor& linear);
at::Tensor srgb_to_linear(const at::Tensor& encoded);

at::Tensor to_tensor(const Image& image, at::Device device = at::kCPU);  ///< [H, W, C]
Image to_image(const at::Tensor& tensor);                                ///< from [H, W, C]

}  // namespace item3d
