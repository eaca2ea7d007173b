#include "item3d/networks/diffusion/controlnet.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

namespace item3d {
namespace nn = torch::nn;
namespace {

nn::Conv2d conv1x1(int channels) {
    return nn::Conv2d(nn::Conv2dOptions(channels, channels, 1));
}

}  // namespace

ControlNetConfig ControlNetConfig::from_config(const Config& config) {
    if (config.text("_class_name", "ControlNetModel") != "ControlNetModel")
        config.fail("_class_name", "ControlNetModel");
    ControlNetConfig result;
    result.read(config);
    config.expect("global_pool_conditions", false);
    result.conditioning_channels = config.size("conditioning_channels", 3);
    result.conditioning_embedding_out_channels = config.sizes(
        "conditioning_embedding_out_channels", result.conditioning_embedding_out_channels);
    if (result.conditioning_embedding_out_channels.size() > 8)
        config.fail("conditioning_embedding_out_channels", "at most 8 sizes");
    for (const int channels : result.conditioning_embedding_out_channels)
        if (channels > 16384)
            config.fail("conditioning_embedding_out_channels", "at most 16384 channels");
    const std::string order = config.text("controlnet_conditioning_channel_order", "rgb");
    if (order != "rgb" && order != "bgr")
        config.fail("controlnet_conditioning_channel_order", "rgb or bgr");
    result.reverse_channels = order == "bgr";
    return result;
}

int ControlNetConfig::downscale() const {
    return 1 << (conditioning_embedding_out_channels.size() - 1);
}

/// Embedding of the image at the latents' size, with the first block's channels.
class ControlNetImpl::ImageEmbedding : public nn::Module {
  public:
    explicit ImageEmbedding(const ControlNetConfig& config) {
        const std::vector<int>& channels = config.conditioning_embedding_out_channels;
        conv_in_ = register_module("conv_in",
                                   nn::Conv2d(conv3x3(config.conditioning_channels, channels[0])));
        nn::ModuleList blocks;
        for (std::size_t i = 0; i + 1 < channels.size(); ++i) {
            append(blocks, blocks_, nn::Conv2d(conv3x3(channels[i], channels[i])));
            append(blocks, blocks_, nn::Conv2d(conv3x3(channels[i], channels[i + 1]).stride(2)));
        }
        register_module("blocks", blocks);
        conv_out_ = register_module(
            "conv_out", nn::Conv2d(conv3x3(channels.back(), config.block_out_channels[0])));
    }
    at::Tensor forward(const at::Tensor& image) {
        at::Tensor x = at::silu(conv_in_(image));
        for (nn::Conv2d& block : blocks_)
            x = at::silu(block(x));
        return conv_out_(x);
    }

  private:
    nn::Conv2d conv_in_{nullptr}, conv_out_{nullptr};
    std::vector<nn::Conv2d> blocks_;
};

ControlNetImpl::ControlNetImpl(const ControlNetConfig& config)
    : UNetEncoderImpl(config), config_(config) {
    image_embedding_ =
        register_module("controlnet_cond_embedding", std::make_shared<ImageEmbedding>(config_));
    make_outputs();
}

ControlNetImpl::~ControlNetImpl() = default;

void ControlNetImpl::make_outputs() {
    nn::ModuleList outputs;
    append(outputs, down_outputs_, conv1x1(config_.block_out_channels[0]));
    for (int i = 0; i < config_.blocks(); ++i) {
        const bool halved = i + 1 < config_.blocks();
        for (int j = 0; j < config_.layers_per_block[i] + (halved ? 1 : 0); ++j)
            append(outputs, down_outputs_, conv1x1(config_.block_out_channels[i]));
    }
    register_module("controlnet_down_blocks", outputs);
    mid_output_ =
        register_module("controlnet_mid_block", conv1x1(config_.block_out_channels.back()));
}

UNetResiduals ControlNetImpl::forward(const at::Tensor& sample, const at::Tensor& timesteps,
                                      const at::Tensor& encoder_hidden_states,
                                      const at::Tensor& image, double scale,
                                      const AddedCondition& added) {
    ITEM3D_CHECK(sample.dim() == 4 && sample.size(1) == config_.in_channels,
                 "sample must be [N, " + std::to_string(config_.in_channels) + ", H, W]");
    ITEM3D_CHECK(image.dim() == 4 && image.size(0) == sample.size(0) &&
                     image.size(1) == config_.conditioning_channels &&
                     image.size(2) == sample.size(2) * config_.downscale() &&
                     image.size(3) == sample.size(3) * config_.downscale(),
                 "the image must have " + std::to_string(config_.downscale()) +
                     " pixels for each latent cell");
    const at::Tensor context = encoder_hidden_states.to(dtype());
    const at::Tensor time = embed(timesteps, sample.size(0), added);
    const at::Tensor seen = (config_.reverse_channels ? image.flip({1}) : image).to(dtype());
    const at::Tensor x = enter(sample.to(dtype())) + image_embedding_->forward(seen);

    UNetResiduals residuals;
    residuals.down = descend(x, time, context);
    residuals.mid = scale * mid_output_(run_middle(residuals.down.back(), time, context));
    for (std::size_t i = 0; i < residuals.down.size(); ++i)
        residuals.down[i] = scale * down_outputs_[i](residuals.down[i]);
    return residuals;
}

ControlNet load_controlnet(const std::filesystem::path& folder, at::Device device,
                           at::ScalarType dtype) {
    const auto config = ControlNetConfig::from_config(Config::read(folder / "config.json"));
    const Weights weights = Weights::open(folder, "diffusion_pytorch_model");
    check_plausible(weights, config.min_parameters());
    auto network = without_initial_values([&] { return ControlNet(config); });
    load_parameters(*network, weights, device, dtype);
    network->eval();
    return network;
}

}  // namespace item3d
