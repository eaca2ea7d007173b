#include "item3d/networks/diffusion/unet.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/group_norm.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

namespace item3d {
namespace nn = torch::nn;

UNet2DConditionImpl::UNet2DConditionImpl(const UNet2DConditionConfig& config)
    : UNetEncoderImpl(config), config_(config) {
    const int first = config_.block_out_channels[0];
    make_up_blocks();
    conv_norm_out_ = register_module(
        "conv_norm_out",
        nn::GroupNorm(nn::GroupNormOptions(config_.norm_num_groups, first).eps(config_.norm_eps)));
    conv_out_ = register_module(
        "conv_out", nn::Conv2d(nn::Conv2dOptions(first, config_.out_channels, 3).padding(1)));
}

void UNet2DConditionImpl::make_up_blocks() {
    nn::ModuleList blocks;
    const int count = config_.blocks();
    int channels = config_.block_out_channels.back();
    for (int i = 0; i < count; ++i) {
        const int mirrored = count - 1 - i;  // down block of the same size
        const int out = config_.block_out_channels[mirrored];
        const int below = config_.block_out_channels[std::max(mirrored - 1, 0)];
        const int layers = config_.layers_per_block[mirrored] + 1;
        UNetLevel level;
        for (int j = 0; j < layers; ++j) {
            const int skip = j + 1 == layers ? below : out;
            level.resnets.push_back(
                ResnetBlock(ResnetBlockImpl::Options{channels + skip, out, config_.time_channels(),
                                                     config_.norm_num_groups, config_.norm_eps}));
            if (config_.up_block_types[i] == "CrossAttnUpBlock2D")
                level.attentions.push_back(SpatialTransformer(SpatialTransformerImpl::Options{
                    out, config_.cross_attention_dim[mirrored],
                    config_.attention_head_dim[mirrored],
                    config_.transformer_layers_per_block[mirrored], config_.norm_num_groups,
                    config_.use_linear_projection}));
            channels = out;
        }
        if (i + 1 < count) level.up = Upsample(out);
        blocks->push_back(level.as_module());
        up_.push_back(std::move(level));
    }
    register_module("up_blocks", blocks);
}

at::Tensor UNet2DConditionImpl::forward(const at::Tensor& sample, const at::Tensor& timesteps,
                                        const at::Tensor& encoder_hidden_states,
                                        const AddedCondition& added, const UNetResiduals& residuals,
                                        AttentionMaps* maps) {
    ITEM3D_CHECK(sample.dim() == 4 && sample.size(1) == config_.in_channels,
                 "sample must be [N, " + std::to_string(config_.in_channels) + ", H, W]");
    const at::Tensor context = encoder_hidden_states.to(dtype());
    const at::Tensor time = embed(timesteps, sample.size(0), added);
    at::Tensor x = sample.to(dtype());
    if (config_.center_input_sample) x = 2 * x - 1;
    std::vector<at::Tensor> skips = descend(enter(x), time, context, maps);
    x = run_middle(skips.back(), time, context, maps);
    if (residuals.mid.defined()) {
        ITEM3D_CHECK(residuals.down.size() == skips.size(), "one residual for each feature map");
        for (std::size_t i = 0; i < skips.size(); ++i)
            skips[i] = skips[i] + residuals.down[i];
        x = x + residuals.mid;
    }
    for (UNetLevel& level : up_) {
        for (std::size_t i = 0; i < level.resnets.size(); ++i) {
            x = level.resnets[i](at::cat({x, skips.back()}, 1), time);
            skips.pop_back();
            if (!level.attentions.empty()) x = level.attentions[i](x, context, maps);
        }
        // Enlarges to the size of the next skip connection. If that size is odd, it is not twice
        // the smaller size.
        if (level.up) x = level.up(x, skips.back().size(2), skips.back().size(3));
    }
    return conv_out_(group_norm(conv_norm_out_, x, Activation::silu));
}

UNet2DCondition load_unet(const std::filesystem::path& folder, at::Device device,
                          at::ScalarType dtype, WeightUse use) {
    const auto config = UNet2DConditionConfig::from_config(Config::read(folder / "config.json"));
    const Weights weights = Weights::open(folder, "diffusion_pytorch_model");
    check_plausible(weights, config.min_parameters());
    auto unet = without_initial_values([&] { return UNet2DCondition(config); });
    load_parameters(*unet, weights, device, dtype, use);
    unet->eval();
    return unet;
}

}  // namespace item3d
