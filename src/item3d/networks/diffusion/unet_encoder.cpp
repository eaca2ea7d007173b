#include "item3d/networks/diffusion/unet_encoder.h"

#include "item3d/core/error.h"

#include <cmath>

namespace item3d {
namespace nn = torch::nn;
namespace {

/// Registers a module of two linear layers under diffusers' names.
void register_embedding(nn::Module& owner, const std::string& name, nn::Linear& first,
                        nn::Linear& second) {
    auto holder = std::make_shared<nn::Module>(name);
    holder->register_module("linear_1", first.ptr());
    holder->register_module("linear_2", second.ptr());
    owner.register_module(name, holder);
}

template <typename Layer>
void register_list(nn::Module& owner, const std::string& name, const std::vector<Layer>& layers) {
    nn::ModuleList list;
    for (const Layer& layer : layers)
        list->push_back(layer);
    owner.register_module(name, list);
}

}  // namespace

at::Tensor sinusoidal_embedding(const at::Tensor& timesteps, int channels, bool flip_sin_to_cos,
                                double freq_shift) {
    const int half = channels / 2;
    const at::Tensor exponent = at::arange(half, at::dtype(at::kFloat).device(timesteps.device())) *
                                (-std::log(10000.0)) / (half - freq_shift);
    const at::Tensor angle = timesteps.to(at::kFloat).unsqueeze(1) * exponent.exp().unsqueeze(0);
    const at::Tensor sine = angle.sin(), cosine = angle.cos();
    return flip_sin_to_cos ? at::cat({cosine, sine}, 1) : at::cat({sine, cosine}, 1);
}

std::shared_ptr<nn::Module> UNetLevel::as_module() const {
    auto module = std::make_shared<nn::Module>("level");
    register_list(*module, "resnets", resnets);
    register_list(*module, "attentions", attentions);
    if (down) register_list<Downsample>(*module, "downsamplers", {down});
    if (up) register_list<Upsample>(*module, "upsamplers", {up});
    return module;
}

UNetEncoderImpl::UNetEncoderImpl(const UNetEncoderConfig& config) : encoder_config_(config) {
    const int first = config.block_out_channels[0], time = config.time_channels();
    conv_in_ = register_module(
        "conv_in", nn::Conv2d(nn::Conv2dOptions(config.in_channels, first, 3).padding(1)));
    time_linear_1_ = nn::Linear(first, time);
    time_linear_2_ = nn::Linear(time, time);
    register_embedding(*this, "time_embedding", time_linear_1_, time_linear_2_);
    if (config.addition_embed_type == "text_time") {
        add_linear_1_ = nn::Linear(config.projection_class_embeddings_input_dim, time);
        add_linear_2_ = nn::Linear(time, time);
        register_embedding(*this, "add_embedding", add_linear_1_, add_linear_2_);
    }
    make_down_blocks();
    make_mid_block();
}

void UNetEncoderImpl::make_down_blocks() {
    const UNetEncoderConfig& config = encoder_config_;
    nn::ModuleList blocks;
    int channels = config.block_out_channels[0];
    for (int i = 0; i < config.blocks(); ++i) {
        const int out = config.block_out_channels[i];
        UNetLevel level;
        for (int j = 0; j < config.layers_per_block[i]; ++j) {
            level.resnets.push_back(ResnetBlock(ResnetBlockImpl::Options{
                channels, out, config.time_channels(), config.norm_num_groups, config.norm_eps}));
            if (config.down_block_types[i] == "CrossAttnDownBlock2D")
                level.attentions.push_back(SpatialTransformer(SpatialTransformerImpl::Options{
                    out, config.cross_attention_dim[i], config.attention_head_dim[i],
                    config.transformer_layers_per_block[i], config.norm_num_groups,
                    config.use_linear_projection}));
            channels = out;
        }
        if (i + 1 < config.blocks()) level.down = Downsample(out, config.downsample_padding);
        blocks->push_back(level.as_module());
        down_.push_back(std::move(level));
    }
    register_module("down_blocks", blocks);
}

void UNetEncoderImpl::make_mid_block() {
    const UNetEncoderConfig& config = encoder_config_;
    const int channels = config.block_out_channels.back();
    const ResnetBlockImpl::Options resnet{channels,
                                          channels,
                                          config.time_channels(),
                                          config.norm_num_groups,
                                          config.norm_eps,
                                          config.mid_block_scale_factor};
    mid_.resnets = {ResnetBlock(resnet), ResnetBlock(resnet)};
    mid_.attentions = {SpatialTransformer(SpatialTransformerImpl::Options{
        channels, config.cross_attention_dim.back(), config.attention_head_dim.back(),
        config.transformer_layers_per_block.back(), config.norm_num_groups,
        config.use_linear_projection})};
    register_module("mid_block", mid_.as_module());
}

at::Tensor UNetEncoderImpl::time_sinusoids(const at::Tensor& timesteps) const {
    return sinusoidal_embedding(timesteps, encoder_config_.block_out_channels[0],
                                encoder_config_.flip_sin_to_cos, encoder_config_.freq_shift);
}

at::Tensor UNetEncoderImpl::time_embedding(const at::Tensor& sinusoids) {
    return time_linear_2_(
        at::silu(time_linear_1_(sinusoids.to(time_linear_1_->weight.scalar_type()))));
}

at::Tensor UNetEncoderImpl::embed(const at::Tensor& timesteps, std::int64_t rows,
                                  const AddedCondition& added) {
    at::Tensor time = time_embedding(time_sinusoids(timesteps.reshape({-1}).expand({rows})));
    if (add_linear_1_) {
        ITEM3D_CHECK(added.text_embeds.defined() && added.time_ids.defined(),
                     "this U-Net needs pooled text and image sizes");
        const at::Tensor sizes =
            sinusoidal_embedding(added.time_ids.flatten(), encoder_config_.addition_time_embed_dim,
                                 encoder_config_.flip_sin_to_cos, encoder_config_.freq_shift)
                .reshape({rows, -1});
        const at::Tensor joined = at::cat({added.text_embeds.to(dtype()), sizes.to(dtype())}, 1);
        time = time + add_linear_2_(at::silu(add_linear_1_(joined)));
    }
    return at::silu(time);  // the first operation of every resnet
}

std::vector<at::Tensor> UNetEncoderImpl::descend(at::Tensor x, const at::Tensor& time,
                                                 const at::Tensor& context,
                                                 AttentionMaps* attention_maps) {
    std::vector<at::Tensor> maps{x};
    for (UNetLevel& level : down_) {
        for (std::size_t i = 0; i < level.resnets.size(); ++i) {
            x = level.resnets[i](x, time);
            if (!level.attentions.empty()) x = level.attentions[i](x, context, attention_maps);
            maps.push_back(x);
        }
        if (level.down) {
            x = level.down(x);
            maps.push_back(x);
        }
    }
    return maps;
}

at::Tensor UNetEncoderImpl::run_middle(at::Tensor x, const at::Tensor& time,
                                       const at::Tensor& context, AttentionMaps* maps) {
    x = mid_.resnets[0](x, time);
    x = mid_.attentions[0](x, context, maps);
    return mid_.resnets[1](x, time);
}

}  // namespace item3d
