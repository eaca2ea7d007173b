#include "item3d/networks/diffusion/autoencoder_tiny.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/layers/rowwise_convolution.h"

#include <torch/nn/modules/activation.h>
#include <torch/nn/modules/linear.h>

#include <algorithm>

namespace item3d {
namespace nn = torch::nn;
/// relu(conv(relu(conv(relu(conv(x))))) + x).
class AutoencoderTiny::Block : public nn::Module {
  public:
    explicit Block(int channels) {
        nn::ModuleList list;
        for (int i = 0; i < 3; ++i) {
            convolutions_.emplace_back(channels, channels);
            list->push_back(convolutions_.back());
            if (i < 2) list->push_back(nn::ReLU());
        }
        register_module("conv", list);
    }
    at::Tensor forward(const at::Tensor& x) {
        at::Tensor hidden = at::relu(convolutions_[0](x));
        hidden = at::relu(convolutions_[1](hidden));
        return at::relu(convolutions_[2](hidden) + x);
    }

  private:
    std::vector<Conv3x3> convolutions_;
};

/// Entry of diffusers' nn.Sequential; one of the first two members is set, or neither.
struct AutoencoderTiny::Layer {
    nn::Conv2d convolution{nullptr};
    std::shared_ptr<Block> block;
    enum class Plain { none, relu, enlarge } plain = Plain::none;
};

void AutoencoderTiny::add(nn::ModuleList& list, std::vector<Layer>& layers, Layer layer) {
    if (layer.convolution) {
        list->push_back(layer.convolution);
    } else if (layer.block) {
        list->push_back(layer.block);
    } else {
        list->push_back(nn::Identity());  // keeps the numbering of diffusers' list
    }
    layers.push_back(std::move(layer));
}

AutoencoderTiny::AutoencoderTiny(const AutoencoderTinyConfig& config) : config_(config) {
    const auto conv = [](const nn::Conv2dOptions& options) {
        return Layer{nn::Conv2d(options), nullptr, Layer::Plain::none};
    };
    const auto block = [](int channels) {
        return Layer{nullptr, std::make_shared<Block>(channels), Layer::Plain::none};
    };
    const auto holder = [&](const char* name, nn::ModuleList& list) {
        auto module = std::make_shared<nn::Module>(name);
        module->register_module("layers", list.ptr());
        register_module(name, module);
    };

    nn::ModuleList encoder;
    for (std::size_t i = 0; i < config_.num_encoder_blocks.size(); ++i) {
        const int channels = config_.encoder_block_out_channels[i];
        add(encoder, encoder_,
            conv(i == 0 ? conv3x3(config_.in_channels, channels)
                        : conv3x3(channels, channels).stride(2).bias(false)));
        for (int j = 0; j < config_.num_encoder_blocks[i]; ++j)
            add(encoder, encoder_, block(channels));
    }
    add(encoder, encoder_,
        conv(conv3x3(config_.encoder_block_out_channels.back(), config_.latent_channels)));
    holder("encoder", encoder);

    nn::ModuleList decoder;
    add(decoder, decoder_,
        conv(conv3x3(config_.latent_channels, config_.decoder_block_out_channels[0])));
    add(decoder, decoder_, Layer{nullptr, nullptr, Layer::Plain::relu});
    for (std::size_t i = 0; i < config_.num_decoder_blocks.size(); ++i) {
        const int channels = config_.decoder_block_out_channels[i];
        const bool last = i + 1 == config_.num_decoder_blocks.size();
        for (int j = 0; j < config_.num_decoder_blocks[i]; ++j)
            add(decoder, decoder_, block(channels));
        if (!last) add(decoder, decoder_, Layer{nullptr, nullptr, Layer::Plain::enlarge});
        add(decoder, decoder_,
            conv(conv3x3(channels, last ? config_.out_channels : channels).bias(last)));
    }
    holder("decoder", decoder);
}

AutoencoderTiny::~AutoencoderTiny() = default;

at::Tensor AutoencoderTiny::run(const std::vector<Layer>& layers, at::Tensor x) {
    for (Layer layer : layers) {
        if (layer.convolution) {
            x = rowwise_convolution(layer.convolution, x);
        } else if (layer.block) {
            x = layer.block->forward(x);
        } else if (layer.plain == Layer::Plain::relu) {
            x = at::relu(x);
        } else {
            x = at::upsample_nearest2d(x, {2 * x.size(2), 2 * x.size(3)});
        }
    }
    return x;
}

at::Tensor AutoencoderTiny::encode(const at::Tensor& images) {
    const at::ScalarType dtype = encoder_[0].convolution->weight.scalar_type();
    return run(encoder_, (images.to(dtype) + 1) / 2);
}

at::Tensor AutoencoderTiny::decode(const at::Tensor& latents) {
    const at::ScalarType dtype = decoder_[0].convolution->weight.scalar_type();
    return run(decoder_, at::tanh(latents.to(dtype) / 3) * 3) * 2 - 1;
}

int AutoencoderTiny::downscale() const {
    return 1 << (config_.num_encoder_blocks.size() - 1);
}

AutoencoderTinyConfig AutoencoderTinyConfig::from_config(const Config& config) {
    config.expect("act_fn", "relu");
    config.expect("upsample_fn", "nearest");
    config.expect("upsampling_scaling_factor", 2);
    config.expect("latent_magnitude", 3);
    config.expect("latent_shift", 0.5);
    AutoencoderTinyConfig result;
    result.in_channels = config.size("in_channels", 3);
    result.out_channels = config.size("out_channels", 3);
    result.latent_channels = config.size("latent_channels", 4);
    const auto levels = [&](const char* channels_key, std::vector<int>& channels,
                            const char* blocks_key, std::vector<int>& blocks) {
        channels = config.sizes(channels_key, channels);
        blocks = config.integers(blocks_key, blocks);
        if (blocks.size() != channels.size() || blocks.size() > 6)
            config.fail(blocks_key, "the same number of entries as " + std::string(channels_key) +
                                        ", at most 6");
        for (const int count : blocks)
            if (count < 0 || count > 64) config.fail(blocks_key, "0 to 64 blocks per level");
        for (const int count : channels)
            if (count != channels[0] || count > 16384)
                config.fail(channels_key,
                            "the same number of channels (at most 16384) in all levels");
    };
    levels("encoder_block_out_channels", result.encoder_block_out_channels, "num_encoder_blocks",
           result.num_encoder_blocks);
    levels("decoder_block_out_channels", result.decoder_block_out_channels, "num_decoder_blocks",
           result.num_decoder_blocks);
    if (result.num_encoder_blocks.size() != result.num_decoder_blocks.size())
        config.fail("num_decoder_blocks", "the same number of levels as num_encoder_blocks");
    result.scaling_factor = config.number("scaling_factor", 1.0);
    result.shift_factor = config.number("shift_factor", 0.0);
    if (!(result.scaling_factor > 0)) config.fail("scaling_factor", "a number above 0");
    return result;
}

nlohmann::json AutoencoderTinyConfig::to_json() const {
    return {
        {"_class_name", "AutoencoderTiny"},
        {"act_fn", "relu"},
        {"block_out_channels", encoder_block_out_channels},
        {"decoder_block_out_channels", decoder_block_out_channels},
        {"encoder_block_out_channels", encoder_block_out_channels},
        {"force_upcast", false},
        {"in_channels", in_channels},
        {"latent_channels", latent_channels},
        {"latent_magnitude", 3},
        {"latent_shift", 0.5},
        {"num_decoder_blocks", num_decoder_blocks},
        {"num_encoder_blocks", num_encoder_blocks},
        {"out_channels", out_channels},
        {"scaling_factor", scaling_factor},
        {"shift_factor", shift_factor},
        {"upsample_fn", "nearest"},
        {"upsampling_scaling_factor", 2},
    };
}

double AutoencoderTinyConfig::min_parameters() const {
    double total = 0;
    for (const auto& [channels, blocks] :
         {std::pair(encoder_block_out_channels, num_encoder_blocks),
          std::pair(decoder_block_out_channels, num_decoder_blocks)})
        for (std::size_t i = 0; i < channels.size(); ++i)
            total += 27.0 * channels[i] * channels[i] * blocks[i];
    return total;
}

}  // namespace item3d
