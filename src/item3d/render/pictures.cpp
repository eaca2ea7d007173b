// Values at covered pixels to pictures, and their transfer functions.

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/cuda/module.h"
#include "item3d/render/kernels/scatter.h"
#include "item3d/render/shade.h"

#include <torch/csrc/autograd/custom_function.h>

#include <cstring>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// values [P, C], pixel [P], background [K, C] with K = 1 or pixels -> [pixels, C].
struct Scatter : torch::autograd::Function<Scatter> {
    static torch::Tensor forward(AutogradContext* context, const torch::Tensor& values,
                                 const torch::Tensor& background, const torch::Tensor& pixel,
                                 std::int64_t pixels) {
        const std::int64_t channels = values.size(1),
                           stride = background.size(0) == 1 ? 0 : channels;
        torch::Tensor picture = torch::empty({pixels, channels}, values.options());
        const kernels::ScatterParameters p{values.const_data_ptr<float>(),
                                           background.const_data_ptr<float>(),
                                           pixel.const_data_ptr<std::int64_t>(),
                                           channels,
                                           stride,
                                           picture.data_ptr<float>()};
        if (values.is_cuda()) {
            const cuda::RenderTable& table = cuda::render_table();
            cuda::run(table.scatter_background, p, pixels, values.device());
            cuda::run(table.scatter_values, p, values.size(0), values.device());
        } else {
            parallel_for(
                "scatter background", pixels,
                [=](std::int64_t i) { kernels::scatter_background(p, i); }, 65536);
            parallel_for(
                "scatter", values.size(0), [=](std::int64_t i) { kernels::scatter_value(p, i); },
                65536);
        }
        context->save_for_backward({pixel});
        context->saved_data["uniform"] = background.size(0) == 1 && pixels != 1;
        return picture;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const torch::Tensor pixel = context->get_saved_variables()[0];
        torch::Tensor by_background;
        if (context->needs_input_grad(1)) {
            by_background = gradients[0].clone();
            by_background.index_fill_(0, pixel, 0);
            if (context->saved_data["uniform"].toBool()) by_background = by_background.sum(0, true);
        }
        return {gradients[0].index_select(0, pixel), by_background, torch::Tensor(),
                torch::Tensor()};
    }
};

}  // namespace

torch::Tensor scatter(const torch::Tensor& values_, const Surface& surface, const Raster& raster,
                      const torch::Tensor& background_) {
    const torch::Device device = operation_device("scatter", values_);
    const std::int64_t count = surface.count();
    const torch::Tensor values =
        checked("scatter", "values", values_, torch::kFloat32, {count, -1}, device);
    const torch::Tensor pixel =
        checked("scatter", "surface.pixel", surface.pixel, torch::kInt64, {count}, device);
    const std::int64_t channels = values.size(1);
    const std::int64_t views = raster.views(), height = raster.height(), width = raster.width();
    const bool uniform = background_.defined() && background_.dim() == 1;
    const torch::Tensor background =
        uniform ? checked("scatter", "background", background_, torch::kFloat32, {channels}, device)
                : checked("scatter", "background", background_, torch::kFloat32,
                          {views, height, width, channels}, device);
    return Scatter::apply(values, background.reshape({-1, channels}), pixel, views * height * width)
        .reshape({views, height, width, channels});
}

torch::Tensor linear_to_srgb(const torch::Tensor& linear) {
    // The power's argument stays above the linear part, where its slope is largest (12.7).
    const torch::Tensor curved = 1.055f * linear.clamp_min(0.0031308f).pow(1.0f / 2.4f) - 0.055f;
    return torch::where(linear <= 0.0031308f, 12.92f * linear, curved);
}

torch::Tensor srgb_to_linear(const torch::Tensor& encoded) {
    const torch::Tensor curved = ((encoded.clamp_min(0.04045f) + 0.055f) / 1.055f).pow(2.4f);
    return torch::where(encoded <= 0.04045f, encoded / 12.92f, curved);
}

torch::Tensor to_tensor(const Image& image, torch::Device device) {
    torch::Tensor tensor =
        torch::empty({image.height, image.width, image.channels}, torch::kFloat32);
    ITEM3D_CHECK(static_cast<std::size_t>(tensor.numel()) == image.pixels.size(),
                 "to_tensor: an image with as many pixels as its size says");
    if (!image.pixels.empty())
        std::memcpy(tensor.data_ptr<float>(), image.pixels.data(),
                    image.pixels.size() * sizeof(float));
    return tensor.to(device);
}

Image to_image(const torch::Tensor& tensor) {
    const torch::Tensor pixels =
        checked("to_image", "tensor", tensor.detach().to(torch::kCPU, torch::kFloat32),
                torch::kFloat32, {-1, -1, -1});
    Image image(static_cast<int>(pixels.size(1)), static_cast<int>(pixels.size(0)),
                static_cast<int>(pixels.size(2)));
    if (!image.pixels.empty())
        std::memcpy(image.pixels.data(), pixels.const_data_ptr<float>(),
                    image.pixels.size() * sizeof(float));
    return image;
}

}  // namespace item3d
