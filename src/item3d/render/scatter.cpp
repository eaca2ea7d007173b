#include "item3d/render/scatter.h"

#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/cuda/module.h"
#include "item3d/render/kernels/scatter.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Returns the background as [pixels, C], with row pixel[i] replaced by values[i]. The background
/// is [K, C], where K is 1 or `pixels`. values is [P, C], and pixel is [P].
struct Scatter : torch::autograd::Function<Scatter> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& values,
                              const at::Tensor& background, const at::Tensor& pixel,
                              std::int64_t pixels) {
        const std::int64_t channels = values.size(1),
                           stride = background.size(0) == 1 ? 0 : channels;
        at::Tensor image = at::empty({pixels, channels}, values.options());
        const kernels::ScatterParameters p{values.const_data_ptr<float>(),
                                           background.const_data_ptr<float>(),
                                           pixel.const_data_ptr<std::int64_t>(),
                                           channels,
                                           stride,
                                           image.data_ptr<float>()};
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
        return image;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const at::Tensor pixel = context->get_saved_variables()[0];
        at::Tensor by_background;
        if (context->needs_input_grad(1)) {
            by_background = gradients[0].clone();
            by_background.index_fill_(0, pixel, 0);
            if (context->saved_data["uniform"].toBool()) by_background = by_background.sum(0, true);
        }
        return {gradients[0].index_select(0, pixel), by_background, at::Tensor(), at::Tensor()};
    }
};

}  // namespace

at::Tensor scatter(const at::Tensor& values_, const Surface& surface, const Raster& raster,
                   const at::Tensor& background_) {
    const at::Device device = operation_device("scatter", values_);
    const std::int64_t count = surface.count();
    const at::Tensor values =
        checked("scatter", "values", values_, at::kFloat, {count, -1}, device);
    const at::Tensor pixel =
        checked("scatter", "surface.pixel", surface.pixel, at::kLong, {count}, device);
    const std::int64_t channels = values.size(1);
    const std::int64_t views = raster.views(), height = raster.height(), width = raster.width();
    const bool uniform = background_.defined() && background_.dim() == 1;
    const at::Tensor background =
        uniform ? checked("scatter", "background", background_, at::kFloat, {channels}, device)
                : checked("scatter", "background", background_, at::kFloat,
                          {views, height, width, channels}, device);
    return Scatter::apply(values, background.reshape({-1, channels}), pixel, views * height * width)
        .reshape({views, height, width, channels});
}

}  // namespace item3d
