#include "item3d/models/unet.h"

#include "item3d/core/error.h"
#include "item3d/models/weights.h"

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

/// The sub-lists of one level, with diffusers' names; empty ones have no parameters anyway.
struct LevelLists {
    nn::ModuleList resnets, attentions, samplers;
    std::shared_ptr<nn::Module> holder = std::make_shared<nn::Module>("level");

    std::shared_ptr<nn::Module> finish(const char* samplers_name) {
        holder->register_module("resnets", resnets.ptr());
        holder->register_module("attentions", attentions.ptr());
        if (samplers_name) holder->register_module(samplers_name, samplers.ptr());
        return holder;
    }
};

}  // namespace

torch::Tensor sinusoidal_embedding(const torch::Tensor& timesteps, int channels,
                                   bool flip_sin_to_cos, double freq_shift) {
    const int half = channels / 2;
    const torch::Tensor exponent =
        torch::arange(half, torch::dtype(torch::kFloat32).device(timesteps.device())) *
        (-std::log(10000.0)) / (half - freq_shift);
    const torch::Tensor angle =
        timesteps.to(torch::kFloat32).unsqueeze(1) * exponent.exp().unsqueeze(0);
    const torch::Tensor sine = angle.sin(), cosine = angle.cos();
    return flip_sin_to_cos ? torch::cat({cosine, sine}, 1) : torch::cat({sine, cosine}, 1);
}

UNet2DConditionImpl::UNet2DConditionImpl(const UNet2DConditionConfig& config)
    : config_(config), time_channels_(4 * config.block_out_channels[0]) {
    const int first = config_.block_out_channels[0];
    conv_in_ = register_module(
        "conv_in", nn::Conv2d(nn::Conv2dOptions(config_.in_channels, first, 3).padding(1)));
    time_linear_1_ = nn::Linear(first, time_channels_);
    time_linear_2_ = nn::Linear(time_channels_, time_channels_);
    register_embedding(*this, "time_embedding", time_linear_1_, time_linear_2_);
    if (config_.addition_embed_type == "text_time") {
        add_linear_1_ = nn::Linear(config_.projection_class_embeddings_input_dim, time_channels_);
        add_linear_2_ = nn::Linear(time_channels_, time_channels_);
        register_embedding(*this, "add_embedding", add_linear_1_, add_linear_2_);
    }
    make_down_blocks();
    make_mid_block();
    make_up_blocks();
    conv_norm_out_ = register_module(
        "conv_norm_out",
        nn::GroupNorm(nn::GroupNormOptions(config_.norm_num_groups, first).eps(config_.norm_eps)));
    conv_out_ = register_module(
        "conv_out", nn::Conv2d(nn::Conv2dOptions(first, config_.out_channels, 3).padding(1)));
}

void UNet2DConditionImpl::make_down_blocks() {
    nn::ModuleList blocks;
    int channels = config_.block_out_channels[0];
    for (int i = 0; i < config_.blocks(); ++i) {
        const int out = config_.block_out_channels[i];
        Level level;
        LevelLists lists;
        for (int j = 0; j < config_.layers_per_block[i]; ++j) {
            append(lists.resnets, level.resnets,
                   ResnetBlock(ResnetBlockImpl::Options{
                       channels, out, time_channels_, config_.norm_num_groups, config_.norm_eps}));
            if (config_.down_block_types[i] == "CrossAttnDownBlock2D")
                append(lists.attentions, level.attentions,
                       SpatialTransformer(SpatialTransformerImpl::Options{
                           out, config_.cross_attention_dim[i], config_.attention_head_dim[i],
                           config_.transformer_layers_per_block[i], config_.norm_num_groups,
                           config_.use_linear_projection}));
            channels = out;
        }
        const bool last = i + 1 == config_.blocks();
        if (!last) {
            level.down = Downsample(out, config_.downsample_padding);
            lists.samplers->push_back(level.down);
        }
        blocks->push_back(lists.finish(last ? nullptr : "downsamplers"));
        down_.push_back(std::move(level));
    }
    register_module("down_blocks", blocks);
}

void UNet2DConditionImpl::make_mid_block() {
    const int channels = config_.block_out_channels.back();
    const ResnetBlockImpl::Options resnet{channels,         channels,
                                          time_channels_,   config_.norm_num_groups,
                                          config_.norm_eps, config_.mid_block_scale_factor};
    LevelLists lists;
    append(lists.resnets, mid_.resnets, ResnetBlock(resnet));
    append(lists.attentions, mid_.attentions,
           SpatialTransformer(SpatialTransformerImpl::Options{
               channels, config_.cross_attention_dim.back(), config_.attention_head_dim.back(),
               config_.transformer_layers_per_block.back(), config_.norm_num_groups,
               config_.use_linear_projection}));
    append(lists.resnets, mid_.resnets, ResnetBlock(resnet));
    register_module("mid_block", lists.finish(nullptr));
}

void UNet2DConditionImpl::make_up_blocks() {
    nn::ModuleList blocks;
    const int count = config_.blocks();
    int channels = config_.block_out_channels.back();
    for (int i = 0; i < count; ++i) {
        const int mirrored = count - 1 - i;  // the down block of the same size
        const int out = config_.block_out_channels[mirrored];
        const int below = config_.block_out_channels[std::max(mirrored - 1, 0)];
        const int layers = config_.layers_per_block[mirrored] + 1;
        Level level;
        LevelLists lists;
        for (int j = 0; j < layers; ++j) {
            const int skip = j + 1 == layers ? below : out;
            append(
                lists.resnets, level.resnets,
                ResnetBlock(ResnetBlockImpl::Options{channels + skip, out, time_channels_,
                                                     config_.norm_num_groups, config_.norm_eps}));
            if (config_.up_block_types[i] == "CrossAttnUpBlock2D")
                append(lists.attentions, level.attentions,
                       SpatialTransformer(SpatialTransformerImpl::Options{
                           out, config_.cross_attention_dim[mirrored],
                           config_.attention_head_dim[mirrored],
                           config_.transformer_layers_per_block[mirrored], config_.norm_num_groups,
                           config_.use_linear_projection}));
            channels = out;
        }
        const bool last = i + 1 == count;
        if (!last) {
            level.up = Upsample(out);
            lists.samplers->push_back(level.up);
        }
        blocks->push_back(lists.finish(last ? nullptr : "upsamplers"));
        up_.push_back(std::move(level));
    }
    register_module("up_blocks", blocks);
}

torch::Tensor UNet2DConditionImpl::time_sinusoids(const torch::Tensor& timesteps) const {
    return sinusoidal_embedding(timesteps, config_.block_out_channels[0], config_.flip_sin_to_cos,
                                config_.freq_shift);
}

torch::Tensor UNet2DConditionImpl::time_embedding(const torch::Tensor& sinusoids) {
    return time_linear_2_(
        torch::silu(time_linear_1_(sinusoids.to(time_linear_1_->weight.scalar_type()))));
}

torch::Tensor UNet2DConditionImpl::forward(const torch::Tensor& sample,
                                           const torch::Tensor& timesteps,
                                           const torch::Tensor& encoder_hidden_states,
                                           const AddedCondition& added) {
    ITEM3D_CHECK(sample.dim() == 4 && sample.size(1) == config_.in_channels,
                 "sample must be [N, " + std::to_string(config_.in_channels) + ", H, W]");
    const auto rows = sample.size(0);
    const torch::Dtype dtype = conv_in_->weight.scalar_type();
    const torch::Tensor context = encoder_hidden_states.to(dtype);

    torch::Tensor time = time_embedding(time_sinusoids(timesteps.reshape({-1}).expand({rows})));
    if (add_linear_1_) {
        ITEM3D_CHECK(added.text_embeds.defined() && added.time_ids.defined(),
                     "this U-Net needs pooled text and picture sizes");
        const torch::Tensor sizes =
            sinusoidal_embedding(added.time_ids.flatten(), config_.addition_time_embed_dim,
                                 config_.flip_sin_to_cos, config_.freq_shift)
                .reshape({rows, -1});
        const torch::Tensor joined = torch::cat({added.text_embeds.to(dtype), sizes.to(dtype)}, 1);
        time = time + add_linear_2_(torch::silu(add_linear_1_(joined)));
    }
    time = torch::silu(time);  // every resnet starts with it

    torch::Tensor x = sample.to(dtype);
    if (config_.center_input_sample) x = 2 * x - 1;
    x = conv_in_(x);
    std::vector<torch::Tensor> skips{x};
    for (Level& level : down_) {
        for (std::size_t i = 0; i < level.resnets.size(); ++i) {
            x = level.resnets[i](x, time);
            if (!level.attentions.empty()) x = level.attentions[i](x, context);
            skips.push_back(x);
        }
        if (level.down) {
            x = level.down(x);
            skips.push_back(x);
        }
    }
    x = mid_.resnets[0](x, time);
    x = mid_.attentions[0](x, context);
    x = mid_.resnets[1](x, time);
    for (Level& level : up_) {
        for (std::size_t i = 0; i < level.resnets.size(); ++i) {
            x = level.resnets[i](torch::cat({x, skips.back()}, 1), time);
            skips.pop_back();
            if (!level.attentions.empty()) x = level.attentions[i](x, context);
        }
        // To the size of the skip that comes next: odd sizes are not twice the smaller one.
        if (level.up) x = level.up(x, skips.back().size(2), skips.back().size(3));
    }
    return conv_out_(torch::silu(conv_norm_out_(x)));
}

UNet2DCondition load_unet(const std::filesystem::path& folder, torch::Device device,
                          torch::Dtype dtype) {
    const auto config = UNet2DConditionConfig::from_config(Config::read(folder / "config.json"));
    const Weights weights = Weights::open(folder, "diffusion_pytorch_model");
    check_plausible(weights, config.least_parameters());
    auto unet = without_initial_values([&] { return UNet2DCondition(config); });
    load_parameters(*unet, weights, device, dtype);
    unet->eval();
    return unet;
}

}  // namespace item3d
