// Images to tensors and back.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

at::Tensor to_tensor(const Image& image, at::Device device = at::kCPU);  ///< [H, W, C]
Image to_image(const at::Tensor& tensor);                                ///< from [H, W, C]

}  // namespace item3d
