#include "item3d/networks/layers/rowwise_convolution.h"

#include "item3d/core/parallel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <ATen/autocast_mode.h>
#include <torch/csrc/autograd/custom_function.h>

#include <optional>
#include <variant>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Convolution with frozen weights that is differentiable in x alone and keeps no activations.
/// LibTorch's conv2d keeps its input for the gradient of the weights, even if that gradient is
/// unused.
struct RowwiseStep : torch::autograd::Function<RowwiseStep> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& x,
                              const at::Tensor& weight, const std::optional<at::Tensor>& bias,
                              std::int64_t stride, std::int64_t padding) {
        context->save_for_backward({weight});
        context->saved_data["sizes"] = x.sizes().vec();
        context->saved_data["stride"] = stride;
        context->saved_data["padding"] = padding;
        return at::conv2d(x, weight, bias, stride, padding);
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const at::Tensor weight = context->get_saved_variables()[0];
        const std::int64_t stride = context->saved_data["stride"].toInt();
        const std::int64_t padding = context->saved_data["padding"].toInt();
        // The input's values do not affect its own gradient.
        const at::Tensor x = at::empty(context->saved_data["sizes"].toIntVector(),
                                       gradients[0].options(), at::MemoryFormat::ChannelsLast);
        const auto by_x = [&](const at::Tensor& input, const at::Tensor& gradient) {
            return std::get<0>(at::convolution_backward(
                gradient, input, weight, c10::nullopt, {stride, stride}, {padding, padding}, {1, 1},
                /*transposed=*/false, {0, 0}, /*groups=*/1, {true, false, false}));
        };
        if (!x.is_cpu() || x.size(2) * x.size(3) > small_map)
            return {by_x(x, gradients[0]), {}, {}, {}, {}};
        parallel_ranges(x.size(0), 1, [&](std::int64_t begin, std::int64_t end) {
            const OneThread alone;
            const at::NoGradGuard no_grad;  // each thread has its own mode
            for (std::int64_t i = begin; i < end; ++i)
                x.narrow(0, i, 1).copy_(by_x(x.narrow(0, i, 1), gradients[0].narrow(0, i, 1)));
        });
        return {x, {}, {}, {}, {}};
    }

    /// Largest map, in pixels, for which each image of the batch is computed by one thread. If
    /// LibTorch computes all images at once, and the convolution has a stride or few channels, its
    /// sums depend on the number of threads. The rounding of the gradient then depends on this
    /// number, too.
    static constexpr std::int64_t small_map = 128 * 128;
};

}  // namespace

at::Tensor rowwise_convolution(torch::nn::Conv2d& convolution, const at::Tensor& x) {
    const at::Tensor &weight = convolution->weight, &bias = convolution->bias;
    const bool only_x = at::GradMode::is_enabled() && x.requires_grad() && x.is_cpu() &&
                        !weight.requires_grad() && !(bias.defined() && bias.requires_grad()) &&
                        !at::autocast::is_autocast_enabled(at::kCPU);
    if (!only_x) return convolution(x);
    const auto& options = convolution->options;
    const std::int64_t padding =
        (*std::get_if<torch::ExpandingArray<2>>(&options.padding()))->front();
    return RowwiseStep::apply(x, weight, bias.defined() ? std::optional(bias) : std::nullopt,
                              options.stride()->front(), padding);
}

}  // namespace item3d
