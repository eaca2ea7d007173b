#include "item3d/networks/diffusion/autoencoder_kl.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/layers/group_norm.h"
#include "item3d/networks/layers/recompute.h"

#include <torch/nn/modules/container/modulelist.h>

namespace item3d {
namespace nn = torch::nn;
namespace {

constexpr double norm_epsilon = 1e-6;

ResnetBlock resnet(const AutoencoderKLConfig& config, int in_channels, int out_channels) {
    return ResnetBlock(ResnetBlockImpl::Options{in_channels, out_channels, 0,
                                                config.norm_num_groups, norm_epsilon});
}

}  // namespace

/// Single-head self-attention over pixels, with its own norm and residual.
class AutoencoderKL::PixelAttention : public AttentionLayerImpl {
  public:
    PixelAttention(const AutoencoderKLConfig& config, int channels)
        : AttentionLayerImpl(channels, channels, 1, true) {
        norm_ = register_module(
            "group_norm",
            nn::GroupNorm(
                nn::GroupNormOptions(config.norm_num_groups, channels).eps(norm_epsilon)));
    }
    at::Tensor over_pixels(const at::Tensor& x) {
        const auto tokens = group_norm(norm_, x).flatten(2).transpose(1, 2);
        return x + forward(tokens).transpose(1, 2).reshape(x.sizes());
    }

  private:
    nn::GroupNorm norm_{nullptr};
};

/// Residual block, attention and residual block at the lowest resolution.
class AutoencoderKL::MidBlock : public nn::Module {
  public:
    MidBlock(const AutoencoderKLConfig& config, int channels) {
        nn::ModuleList resnets, attentions;
        append(resnets, resnets_, resnet(config, channels, channels));
        append(resnets, resnets_, resnet(config, channels, channels));
        if (config.mid_block_add_attention) {
            attention_ = std::make_shared<PixelAttention>(config, channels);
            attentions->push_back(attention_);
        }
        register_module("resnets", resnets);
        register_module("attentions", attentions);
    }
    at::Tensor forward(at::Tensor x) {
        x = resnets_[0](x);
        if (attention_) x = attention_->over_pixels(x);
        return resnets_[1](x);
    }

  private:
    std::vector<ResnetBlock> resnets_;
    std::shared_ptr<PixelAttention> attention_;
};

class AutoencoderKL::Encoder : public nn::Module {
  public:
    explicit Encoder(const AutoencoderKLConfig& config) {
        const auto& widths = config.block_out_channels;
        conv_in_ = register_module("conv_in", nn::Conv2d(conv3x3(config.in_channels, widths[0])));
        nn::ModuleList blocks;
        int channels = widths[0];
        for (std::size_t i = 0; i < widths.size(); ++i) {
            auto level = std::make_shared<nn::Module>("level");
            nn::ModuleList resnets, samplers;
            Level typed;
            for (int j = 0; j < config.layers_per_block; ++j) {
                append(resnets, typed.resnets, resnet(config, channels, widths[i]));
                channels = widths[i];
            }
            level->register_module("resnets", resnets.ptr());
            if (i + 1 < widths.size()) {
                typed.down = Downsample(channels, 0);
                samplers->push_back(typed.down);
                level->register_module("downsamplers", samplers.ptr());
            }
            blocks->push_back(level);
            levels_.push_back(std::move(typed));
        }
        register_module("down_blocks", blocks);
        mid_block_ = register_module("mid_block", std::make_shared<MidBlock>(config, channels));
        conv_norm_out_ = register_module(
            "conv_norm_out",
            nn::GroupNorm(
                nn::GroupNormOptions(config.norm_num_groups, channels).eps(norm_epsilon)));
        conv_out_ =
            register_module("conv_out", nn::Conv2d(conv3x3(channels, 2 * config.latent_channels)));
    }
    at::Tensor forward(const at::Tensor& images) {
        at::Tensor x = conv_in_(images.to(conv_in_->weight.scalar_type()));
        for (Level& level : levels_) {
            for (ResnetBlock& block : level.resnets)
                x = recompute ? recomputed([block = block.ptr()](
                                               const at::Tensor& y) { return block->forward(y); },
                                           x)
                              : block(x);
            if (level.down) x = level.down(x);
        }
        return conv_out_(group_norm(conv_norm_out_, mid_block_->forward(x), Activation::silu));
    }

    bool recompute = false;  ///< see recompute.h

  private:
    struct Level {
        std::vector<ResnetBlock> resnets;
        Downsample down{nullptr};
    };
    nn::Conv2d conv_in_{nullptr}, conv_out_{nullptr};
    nn::GroupNorm conv_norm_out_{nullptr};
    std::vector<Level> levels_;
    std::shared_ptr<MidBlock> mid_block_;
};

class AutoencoderKL::Decoder : public nn::Module {
  public:
    explicit Decoder(const AutoencoderKLConfig& config) {
        const auto& widths = config.block_out_channels;
        int channels = widths.back();
        conv_in_ =
            register_module("conv_in", nn::Conv2d(conv3x3(config.latent_channels, channels)));
        mid_block_ = register_module("mid_block", std::make_shared<MidBlock>(config, channels));
        nn::ModuleList blocks;
        for (std::size_t i = 0; i < widths.size(); ++i) {
            const int out = widths[widths.size() - 1 - i];
            auto level = std::make_shared<nn::Module>("level");
            nn::ModuleList resnets, samplers;
            Level typed;
            for (int j = 0; j < config.layers_per_block + 1; ++j) {
                append(resnets, typed.resnets, resnet(config, channels, out));
                channels = out;
            }
            level->register_module("resnets", resnets.ptr());
            if (i + 1 < widths.size()) {
                typed.up = Upsample(channels);
                samplers->push_back(typed.up);
                level->register_module("upsamplers", samplers.ptr());
            }
            blocks->push_back(level);
            levels_.push_back(std::move(typed));
        }
        register_module("up_blocks", blocks);
        conv_norm_out_ = register_module(
            "conv_norm_out",
            nn::GroupNorm(
                nn::GroupNormOptions(config.norm_num_groups, channels).eps(norm_epsilon)));
        conv_out_ = register_module("conv_out", nn::Conv2d(conv3x3(channels, config.out_channels)));
    }
    at::Tensor forward(const at::Tensor& latents) {
        at::Tensor x = mid_block_->forward(conv_in_(latents.to(conv_in_->weight.scalar_type())));
        for (Level& level : levels_) {
            for (ResnetBlock& block : level.resnets)
                x = block(x);
            if (level.up) x = level.up(x, 2 * x.size(2), 2 * x.size(3));
        }
        return conv_out_(group_norm(conv_norm_out_, x, Activation::silu));
    }

  private:
    struct Level {
        std::vector<ResnetBlock> resnets;
        Upsample up{nullptr};
    };
    nn::Conv2d conv_in_{nullptr}, conv_out_{nullptr};
    nn::GroupNorm conv_norm_out_{nullptr};
    std::vector<Level> levels_;
    std::shared_ptr<MidBlock> mid_block_;
};

AutoencoderKL::AutoencoderKL(const AutoencoderKLConfig& config, bool with_decoder)
    : config_(config) {
    const int latent = config_.latent_channels;
    encoder_ = register_module("encoder", std::make_shared<Encoder>(config_));
    if (with_decoder) decoder_ = register_module("decoder", std::make_shared<Decoder>(config_));
    if (config_.use_quant_conv)
        quant_conv_ =
            register_module("quant_conv", nn::Conv2d(nn::Conv2dOptions(2 * latent, 2 * latent, 1)));
    if (with_decoder && config_.use_post_quant_conv)
        post_quant_conv_ =
            register_module("post_quant_conv", nn::Conv2d(nn::Conv2dOptions(latent, latent, 1)));
}

LatentDistribution AutoencoderKL::encode_distribution(const at::Tensor& images) {
    at::Tensor moments = encoder_->forward(images);
    if (quant_conv_) moments = quant_conv_(moments);
    const auto halves = moments.chunk(2, 1);
    return {halves[0], halves[1].clamp(-30.0, 20.0)};
}

at::Tensor AutoencoderKL::encode(const at::Tensor& images) {
    return encode_distribution(images).mean;
}

void AutoencoderKL::recompute_in_backward(bool on) {
    encoder_->recompute = on;
}

at::Tensor AutoencoderKL::decode(const at::Tensor& latents) {
    ITEM3D_CHECK(decoder_, "was loaded without a decoder");
    if (!post_quant_conv_) return decoder_->forward(latents);
    return decoder_->forward(post_quant_conv_(latents.to(post_quant_conv_->weight.scalar_type())));
}

int AutoencoderKL::downscale() const {
    return 1 << (config_.block_out_channels.size() - 1);
}

AutoencoderKLConfig AutoencoderKLConfig::from_config(const Config& config) {
    AutoencoderKLConfig result;
    config.expect("act_fn", "silu");
    config.expect("latents_mean", nullptr);
    config.expect("latents_std", nullptr);
    result.in_channels = config.size("in_channels", 3);
    result.out_channels = config.size("out_channels", 3);
    result.latent_channels = config.size("latent_channels", 4);
    result.block_out_channels = config.sizes("block_out_channels", {64});
    const std::size_t count = result.block_out_channels.size();
    if (count > 6) config.fail("block_out_channels", "at most 6 blocks");
    const auto types = [&](const char* key, const std::string& type) {
        const auto found = config.texts(key, std::vector<std::string>(count, type));
        if (found != std::vector<std::string>(count, type))
            config.fail(key, std::to_string(count) + " times " + type);
    };
    types("down_block_types", "DownEncoderBlock2D");
    types("up_block_types", "UpDecoderBlock2D");
    result.layers_per_block = config.size("layers_per_block", 1);
    if (result.layers_per_block > 16) config.fail("layers_per_block", "at most 16");
    result.norm_num_groups = config.size("norm_num_groups", 32);
    for (const int channels : result.block_out_channels) {
        if (channels > 16384) config.fail("block_out_channels", "at most 16384 channels");
        if (channels % result.norm_num_groups != 0)
            config.fail("norm_num_groups", "a divisor of every block's channels");
    }
    result.mid_block_add_attention = config.boolean("mid_block_add_attention", true);
    result.use_quant_conv = config.boolean("use_quant_conv", true);
    result.use_post_quant_conv = config.boolean("use_post_quant_conv", true);
    result.scaling_factor = config.number("scaling_factor", 0.18215);
    result.shift_factor = config.number("shift_factor", 0.0);
    if (!(result.scaling_factor > 0)) config.fail("scaling_factor", "a number above 0");
    if (config.has("sample_size")) result.sample_size = config.sizes("sample_size", {512})[0];
    return result;
}

nlohmann::json AutoencoderKLConfig::to_json() const {
    const std::size_t count = block_out_channels.size();
    return {
        {"_class_name", "AutoencoderKL"},
        {"act_fn", "silu"},
        {"block_out_channels", block_out_channels},
        {"down_block_types", std::vector<std::string>(count, "DownEncoderBlock2D")},
        {"in_channels", in_channels},
        {"latent_channels", latent_channels},
        {"layers_per_block", layers_per_block},
        {"mid_block_add_attention", mid_block_add_attention},
        {"norm_num_groups", norm_num_groups},
        {"out_channels", out_channels},
        {"sample_size", sample_size},
        {"scaling_factor", scaling_factor},
        {"up_block_types", std::vector<std::string>(count, "UpDecoderBlock2D")},
        {"use_post_quant_conv", use_post_quant_conv},
        {"use_quant_conv", use_quant_conv},
    };
}

double AutoencoderKLConfig::min_parameters() const {
    double total = 0;
    for (const int channels : block_out_channels)
        total += 18.0 * channels * channels * layers_per_block;
    return total;
}

}  // namespace item3d
