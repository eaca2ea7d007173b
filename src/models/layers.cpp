#include "item3d/models/layers.h"

#include <cmath>
#include <variant>

namespace item3d {
namespace {

// Like LibTorch's gradient mode: a property of the code that is running, kept a thread.
thread_local bool without_values = false;

/// Values as PyTorch's Linear and Conv2d have them at first: uniform, of variance 1 / (3 fan_in).
torch::Tensor uniform(torch::IntArrayRef shape, std::int64_t fan_in) {
    torch::Tensor tensor = torch::empty(shape);
    if (without_values) return tensor;
    const double bound = fan_in > 0 ? 1 / std::sqrt(static_cast<double>(fan_in)) : 0.0;
    return tensor.uniform_(-bound, bound);
}

torch::Tensor filled(torch::IntArrayRef shape, double value) {
    return without_values ? torch::empty(shape) : torch::full(shape, value, torch::kFloat32);
}

}  // namespace

WithoutValues::WithoutValues() : before_(without_values) {
    without_values = true;
}

WithoutValues::~WithoutValues() {
    without_values = before_;
}

LinearImpl::LinearImpl(const LinearOptions& options) {
    const std::int64_t in = options.in_features(), out = options.out_features();
    weight = register_parameter("weight", uniform({out, in}, in));
    if (options.bias()) bias = register_parameter("bias", uniform({out}, in));
}

Conv2dImpl::Conv2dImpl(const Conv2dOptions& options)
    : stride_(options.stride()->begin(), options.stride()->end()),
      padding_(std::get<torch::ExpandingArray<2>>(options.padding())->begin(),
               std::get<torch::ExpandingArray<2>>(options.padding())->end()) {
    const std::int64_t in = options.in_channels(), out = options.out_channels();
    const std::int64_t height = options.kernel_size()->at(0), width = options.kernel_size()->at(1);
    const std::int64_t fan_in = in * height * width;
    weight = register_parameter("weight", uniform({out, in, height, width}, fan_in));
    if (options.bias()) bias = register_parameter("bias", uniform({out}, fan_in));
}

GroupNormImpl::GroupNormImpl(const GroupNormOptions& options) : options_(options) {
    weight = register_parameter("weight", filled({options.num_channels()}, 1));
    bias = register_parameter("bias", filled({options.num_channels()}, 0));
}

LayerNormImpl::LayerNormImpl(const LayerNormOptions& options) : options_(options) {
    weight = register_parameter("weight", filled(options.normalized_shape(), 1));
    bias = register_parameter("bias", filled(options.normalized_shape(), 0));
}

EmbeddingImpl::EmbeddingImpl(std::int64_t count, std::int64_t width) {
    torch::Tensor values = torch::empty({count, width});
    weight = register_parameter("weight", without_values ? values : values.normal_());
}

}  // namespace item3d
