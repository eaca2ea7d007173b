#include "item3d/models/clip_layer.h"

#include "item3d/models/attention.h"

namespace item3d {
namespace nn = torch::nn;

ClipLayerImpl::ClipLayerImpl(const ClipLayerOptions& options)
    : heads_(options.heads), quick_(options.activation == "quick_gelu") {
    const int width = options.width;
    const auto norm = nn::LayerNormOptions({width}).eps(options.epsilon);
    norm1_ = register_module("layer_norm1", nn::LayerNorm(norm));
    norm2_ = register_module("layer_norm2", nn::LayerNorm(norm));
    auto attention = std::make_shared<nn::Module>("attention");
    query_ = attention->register_module("q_proj", nn::Linear(width, width));
    key_ = attention->register_module("k_proj", nn::Linear(width, width));
    value_ = attention->register_module("v_proj", nn::Linear(width, width));
    output_ = attention->register_module("out_proj", nn::Linear(width, width));
    register_module("self_attn", attention);
    auto mlp = std::make_shared<nn::Module>("mlp");
    feed_in_ = mlp->register_module("fc1", nn::Linear(width, options.intermediate));
    feed_out_ = mlp->register_module("fc2", nn::Linear(options.intermediate, width));
    register_module("mlp", mlp);
}

torch::Tensor ClipLayerImpl::forward(torch::Tensor x, const torch::Tensor& mask) {
    const torch::Tensor normed = norm1_(x);
    x = x + output_(attention(query_(normed), key_(normed), value_(normed), heads_, mask));
    const torch::Tensor hidden = feed_in_(norm2_(x));
    return x + feed_out_(quick_ ? hidden * torch::sigmoid(1.702 * hidden) : torch::gelu(hidden));
}

}  // namespace item3d
