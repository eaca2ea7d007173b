#include "item3d/networks/layers/conv3x3.h"

#include <ATen/autocast_mode.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/custom_class.h>

#include <utility>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

struct ConvolutionHolder : torch::CustomClassHolder {
    explicit ConvolutionHolder(std::shared_ptr<FrozenConvolution> held)
        : convolution(std::move(held)) {}
    std::shared_ptr<FrozenConvolution> convolution;
};

/// Frozen convolution, differentiable in x alone.
struct FrozenStep : torch::autograd::Function<FrozenStep> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& x,
                              const std::shared_ptr<FrozenConvolution>& convolution,
                              const at::Tensor& bias) {
        context->saved_data["convolution"] =
            c10::IValue::make_capsule(c10::intrusive_ptr<torch::CustomClassHolder>(
                c10::make_intrusive<ConvolutionHolder>(convolution)));
        return convolution->forward(x, bias);
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto holder = context->saved_data["convolution"].toCapsule();
        return {static_cast<ConvolutionHolder&>(*holder).convolution->backward(gradients[0]),
                at::Tensor(), at::Tensor()};
    }
};

}  // namespace

Conv3x3Impl::Conv3x3Impl(int in_channels, int out_channels, bool with_bias)
    : Conv2dImpl(
          torch::nn::Conv2dOptions(in_channels, out_channels, 3).padding(1).bias(with_bias)) {}

void Conv3x3Impl::map_weights(const at::Tensor& stored, std::function<void()> release_pages) {
    weight.set_data(stored);
    release_pages_ = std::move(release_pages);
}

void Conv3x3Impl::take_from_file(at::ScalarType dtype) {
    if (!runs_from_file()) return;
    weight.set_data(
        at::empty(weight.sizes(), weight.options().dtype(dtype), at::MemoryFormat::ChannelsLast)
            .copy_(weight));
    std::exchange(release_pages_, nullptr)();
}

std::shared_ptr<FrozenConvolution> Conv3x3Impl::faster_way(const at::Tensor& x) {
    const std::lock_guard lock(mutex_);
    if (weight_given_up_) return fast_;
    const bool frozen = !weight.requires_grad() && !(bias.defined() && bias.requires_grad()) &&
                        !at::autocast::is_autocast_enabled(x.device().type());
    if (!frozen) return nullptr;
    const bool packs = runs_from_file() || x.scalar_type() == weight.scalar_type();
    if (!fast_ || !fast_->is_of(weight))
        fast_ = packs ? FrozenConvolution::make(x, weight, release_pages_) : nullptr;
    if (!fast_) {
        take_from_file(x.scalar_type());
        return nullptr;
    }
    if (only_runs_ && !runs_from_file() && fast_->release_weight()) {
        weight.set_data(at::empty({0}, weight.options()));
        weight_given_up_ = true;
    }
    return fast_;
}

at::Tensor Conv3x3Impl::forward(const at::Tensor& x) {
    const std::shared_ptr<FrozenConvolution> fast = faster_way(x);
    if (!fast) return Conv2dImpl::forward(x);
    if (at::GradMode::is_enabled() && x.requires_grad()) return FrozenStep::apply(x, fast, bias);
    return fast->forward(x, bias);
}

}  // namespace item3d
