// Conversion between images and tensors.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

at::Tensor to_tensor(const Image& image, at::Device device = at::kCPU);  ///< returns [H, W, C]
Image to_image(const at::Tensor& tensor);                                ///< takes [H, W, C]

}  // namespace item3d
