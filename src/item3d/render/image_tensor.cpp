#include "item3d/render/image_tensor.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"

#include <cstring>

namespace item3d {

at::Tensor to_tensor(const Image& image, at::Device device) {
    at::Tensor tensor = at::empty({image.height, image.width, image.channels}, at::kFloat);
    ITEM3D_CHECK(static_cast<std::size_t>(tensor.numel()) == image.pixels.size(),
                 "to_tensor: an image with as many pixels as its size says");
    if (!image.pixels.empty())
        std::memcpy(tensor.data_ptr<float>(), image.pixels.data(),
                    image.pixels.size() * sizeof(float));
    return tensor.to(device);
}

Image to_image(const at::Tensor& tensor) {
    const at::Tensor pixels = checked(
        "to_image", "tensor", tensor.detach().to(at::kCPU, at::kFloat), at::kFloat, {-1, -1, -1});
    Image image(static_cast<int>(pixels.size(1)), static_cast<int>(pixels.size(0)),
                static_cast<int>(pixels.size(2)));
    if (!image.pixels.empty())
        std::memcpy(image.pixels.data(), pixels.const_data_ptr<float>(),
                    image.pixels.size() * sizeof(float));
    return image;
}

}  // namespace item3d
