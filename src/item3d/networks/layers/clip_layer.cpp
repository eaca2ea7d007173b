#include "item3d/networks/layers/clip_layer.h"

#include "item3d/networks/layers/attention.h"

namespace item3d {
namespace nn = torch::nn;

ClipLayerImpl::ClipLayerImpl(const ClipLayerOptions& options)
    : heads_(options.heads),
      activation_(options.activation == "quick_gelu" ? LinearActivation::quick_gelu
                                                     : LinearActivation::gelu) {
    const int width = options.width;
    const auto norm = nn::LayerNormOptions({width}).eps(options.epsilon);
    norm1_ = register_module("layer_norm1", nn::LayerNorm(norm));
    norm2_ = register_module("layer_norm2", nn::LayerNorm(norm));
    auto attention = std::make_shared<nn::Module>("attention");
    query_ = attention->register_module("q_proj", PackableLinear(width, width));
    key_ = attention->register_module("k_proj", PackableLinear(width, width));
    value_ = attention->register_module("v_proj", PackableLinear(width, width));
    output_ = attention->register_module("out_proj", PackableLinear(width, width));
    register_module("self_attn", attention);
    auto mlp = std::make_shared<nn::Module>("mlp");
    feed_in_ = mlp->register_module("fc1", PackableLinear(width, options.intermediate));
    feed_out_ = mlp->register_module("fc2", PackableLinear(options.intermediate, width));
    register_module("mlp", mlp);
}

at::Tensor ClipLayerImpl::attend(const at::Tensor& x, const at::Tensor& normed,
                                 const at::Tensor& mask) {
    const at::Tensor asking = normed.narrow(1, 0, x.size(1));
    const at::Tensor heard = attention(query_(asking), key_(normed), value_(normed), heads_, mask);
    const at::Tensor y = output_->forward(heard, {.added = x});
    const at::Tensor hidden =
        feed_in_->forward(norm2_(y), {.activation = activation_, .rounded = true});
    return feed_out_->forward(hidden, {.added = y});
}

at::Tensor ClipLayerImpl::forward(const at::Tensor& x, const at::Tensor& mask) {
    return attend(x, query_->as_read(norm1_(x)), mask);
}

at::Tensor ClipLayerImpl::forward_first(const at::Tensor& x) {
    return attend(x.narrow(1, 0, 1), query_->as_read(norm1_(x)), {});
}

}  // namespace item3d
