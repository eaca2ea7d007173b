#include "item3d/networks/diffusion/unet_blocks.h"

#include "item3d/networks/layers/attention.h"
#include "item3d/networks/layers/gated_gelu.h"
#include "item3d/networks/layers/group_norm.h"
#include "item3d/networks/layers/rowwise_convolution.h"

#include <ATen/autocast_mode.h>

namespace item3d {
namespace nn = torch::nn;
namespace {

nn::GroupNorm make_norm(int groups, int channels, double epsilon) {
    return nn::GroupNorm(nn::GroupNormOptions(groups, channels).eps(epsilon));
}

/// Applies a 1x1 convolution. With frozen float32 weights it is computed as a matrix product,
/// because LibTorch's own 1x1 convolution is slower.
at::Tensor pointwise(nn::Conv2d& convolution, const at::Tensor& x) {
    const at::Tensor &weight = convolution->weight, &bias = convolution->bias;
    const bool product = x.is_cpu() && x.scalar_type() == at::kFloat &&
                         weight.scalar_type() == at::kFloat && !weight.requires_grad() &&
                         !bias.requires_grad() && !at::autocast::is_autocast_enabled(at::kCPU);
    if (!product) return convolution(x);
    return at::linear(x.permute({0, 2, 3, 1}), weight.view({weight.size(0), -1}), bias)
        .permute({0, 3, 1, 2});
}

}  // namespace

ResnetBlockImpl::ResnetBlockImpl(const Options& options) : options_(options) {
    const int in = options.in_channels, out = options.out_channels;
    norm1_ = register_module("norm1", make_norm(options.groups, in, options.epsilon));
    conv1_ = register_module("conv1", Conv3x3(in, out));
    if (options.time_channels > 0)
        time_emb_proj_ =
            register_module("time_emb_proj", PackableLinear(options.time_channels, out));
    norm2_ = register_module("norm2", make_norm(options.groups, out, options.epsilon));
    conv2_ = register_module("conv2", Conv3x3(out, out));
    if (in != out)
        conv_shortcut_ =
            register_module("conv_shortcut", nn::Conv2d(nn::Conv2dOptions(in, out, 1)));
}

at::Tensor ResnetBlockImpl::forward(const at::Tensor& x, const at::Tensor& time) {
    at::Tensor hidden = conv1_(group_norm(norm1_, x, Activation::silu));
    if (time_emb_proj_) hidden = hidden + time_emb_proj_(time).unsqueeze(-1).unsqueeze(-1);
    hidden = conv2_(group_norm(norm2_, hidden, Activation::silu));
    const at::Tensor sum = (conv_shortcut_ ? pointwise(conv_shortcut_, x) : x) + hidden;
    return options_.output_scale == 1.0 ? sum : sum / options_.output_scale;
}

AttentionLayerImpl::AttentionLayerImpl(int channels, int context_channels, int heads, bool bias)
    : heads_(heads) {
    to_q_ =
        register_module("to_q", PackableLinear(nn::LinearOptions(channels, channels).bias(bias)));
    to_k_ = register_module(
        "to_k", PackableLinear(nn::LinearOptions(context_channels, channels).bias(bias)));
    to_v_ = register_module(
        "to_v", PackableLinear(nn::LinearOptions(context_channels, channels).bias(bias)));
    to_out_ = register_module("to_out", nn::ModuleList(PackableLinear(channels, channels)));
}

at::Tensor AttentionLayerImpl::forward(const at::Tensor& x, const at::Tensor& context,
                                       AttentionMaps* maps) {
    const at::Tensor& source = context.defined() ? context : x;
    const at::Tensor query = to_q_(x), key = to_k_(source);
    if (maps) maps->add(query, key, heads_);
    const at::Tensor result = attention(query, key, to_v_(source), heads_);
    return to_out_[0]->as<PackableLinear>()->forward(result);
}

TransformerBlockImpl::TransformerBlockImpl(int channels, int context_channels, int heads) {
    const nn::LayerNormOptions norm({channels});
    norm1_ = register_module("norm1", nn::LayerNorm(norm));
    attn1_ = register_module("attn1", AttentionLayer(channels, channels, heads));
    norm2_ = register_module("norm2", nn::LayerNorm(norm));
    attn2_ = register_module("attn2", AttentionLayer(channels, context_channels, heads));
    norm3_ = register_module("norm3", nn::LayerNorm(norm));

    // The list ff.net of diffusers is [GEGLU{proj}, Dropout, Linear]. The dropout is never active
    // here.
    constexpr int expansion = 4;
    feed_in_ = PackableLinear(channels, 2 * expansion * channels);
    feed_out_ = PackableLinear(expansion * channels, channels);
    auto gate = std::make_shared<nn::Module>("GEGLU");
    gate->register_module("proj", feed_in_.ptr());
    nn::ModuleList net;
    net->push_back(gate);
    net->push_back(nn::Identity());
    net->push_back(feed_out_);
    auto feed_forward = std::make_shared<nn::Module>("FeedForward");
    feed_forward->register_module("net", net.ptr());
    register_module("ff", feed_forward);
}

at::Tensor TransformerBlockImpl::forward(at::Tensor x, const at::Tensor& context,
                                         AttentionMaps* maps) {
    x = x + attn1_(norm1_(x));
    x = x + attn2_(norm2_(x), context, maps);
    return x + feed_out_(gated_gelu(feed_in_(norm3_(x))));
}

SpatialTransformerImpl::SpatialTransformerImpl(const Options& options) : options_(options) {
    const int channels = options.channels;
    norm_ = register_module("norm", make_norm(options.groups, channels, 1e-6));
    if (options.linear_projection) {
        linear_in_ = register_module("proj_in", PackableLinear(channels, channels));
        linear_out_ = register_module("proj_out", PackableLinear(channels, channels));
    } else {
        const nn::Conv2dOptions pointwise(channels, channels, 1);
        conv_in_ = register_module("proj_in", nn::Conv2d(pointwise));
        conv_out_ = register_module("proj_out", nn::Conv2d(pointwise));
    }
    nn::ModuleList list;
    for (int i = 0; i < options.layers; ++i)
        append(list, blocks_, TransformerBlock(channels, options.context_channels, options.heads));
    register_module("transformer_blocks", list);
}

at::Tensor SpatialTransformerImpl::forward(const at::Tensor& x, const at::Tensor& context,
                                           AttentionMaps* maps) {
    const auto rows = x.size(0), channels = x.size(1), height = x.size(2), width = x.size(3);
    if (maps) maps->set_layer(height, width);
    at::Tensor hidden = group_norm(norm_, x);
    if (conv_in_) hidden = pointwise(conv_in_, hidden);
    hidden = hidden.permute({0, 2, 3, 1}).reshape({rows, height * width, channels});
    if (linear_in_) hidden = linear_in_(hidden);
    for (TransformerBlock& block : blocks_)
        hidden = block(hidden, context, maps);
    if (linear_out_) hidden = linear_out_(hidden);
    hidden = hidden.reshape({rows, height, width, channels}).permute({0, 3, 1, 2});
    if (conv_out_) hidden = pointwise(conv_out_, hidden);
    return x + hidden;
}

DownsampleImpl::DownsampleImpl(int channels, int padding) : padding_(padding) {
    conv_ = register_module(
        "conv", nn::Conv2d(nn::Conv2dOptions(channels, channels, 3).stride(2).padding(padding)));
}

at::Tensor DownsampleImpl::forward(const at::Tensor& x) {
    const at::Tensor padded = padding_ == 0 ? at::constant_pad_nd(x, {0, 1, 0, 1}) : x;
    return rowwise_convolution(conv_, padded);
}

UpsampleImpl::UpsampleImpl(int channels) {
    conv_ = register_module("conv", Conv3x3(channels, channels));
}

at::Tensor UpsampleImpl::forward(const at::Tensor& x, std::int64_t height, std::int64_t width) {
    return conv_(at::upsample_nearest2d(x, {height, width}));
}

}  // namespace item3d
