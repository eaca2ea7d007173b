#include "item3d/networks/diffusion/diffusion_networks.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/layers/load_parameters.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void mismatch(const fs::path& folder, const std::string& part,
                           const std::string& problem) {
    throw InputError((folder / part / "config.json").string(), problem,
                     "the folder contains parts of different models");
}

void check_text_fit(const fs::path& folder, const TextEncoders& text,
                    const UNet2DConditionConfig& config) {
    int width_given = text.model->config().hidden_size;
    int added = 0;
    if (text.is_sdxl()) {
        const ClipTextConfig& second = text.model_2->config();
        width_given += second.hidden_size;
        added = second.projection_dim;
    }
    for (const int width : config.cross_attention_dim)
        if (width != width_given)
            mismatch(folder, "unet",
                     fmt::format("cross_attention_dim is {}, but the text embedding has {}", width,
                                 width_given));
    if (config.addition_embed_type.empty() == text.is_sdxl())
        mismatch(folder, "unet",
                 text.is_sdxl() ? "SDXL requires addition_embed_type text_time"
                                : "addition_embed_type requires a second text encoder (SDXL)");
    added += image_sizes * config.addition_time_embed_dim;
    if (text.is_sdxl() && config.projection_class_embeddings_input_dim != added)
        mismatch(folder, "unet",
                 fmt::format("projection_class_embeddings_input_dim is {}, but pooled text and {} "
                             "image sizes have {}",
                             config.projection_class_embeddings_input_dim, image_sizes, added));
}

void check_latents_fit(const fs::path& folder, const DiffusionNetworks& networks) {
    const UNet2DConditionConfig& config = networks.unet->config();
    const int latents = networks.latent_channels();
    if (config.out_channels != latents || config.in_channels < latents)
        mismatch(folder, "unet",
                 fmt::format("{} to {} channels do not fit the VAE's {} latent channels",
                             config.in_channels, config.out_channels, latents));
}

}  // namespace

void use_channels_last(torch::nn::Module& module) {
    for (const auto& layer : module.modules()) {
        const auto* convolution = layer->as<Conv3x3>();
        if (convolution && convolution->runs_from_file()) continue;
        for (at::Tensor& parameter : layer->parameters(/*recurse=*/false))
            if (parameter.dim() == 4)
                parameter.set_data(parameter.contiguous(at::MemoryFormat::ChannelsLast));
    }
}

DiffusionNetworks DiffusionNetworks::load(const fs::path& folder, const TextEncoders& text,
                                          at::Device device, at::ScalarType dtype,
                                          bool with_decoder, WeightUse use) {
    DiffusionNetworks networks;
    networks.unet = load_unet(folder / "unet", device, dtype, use);
    networks.vae = load_autoencoder(folder / "vae", device, dtype, with_decoder, use);
    networks.scheduler = NoiseSchedule::load(folder / "scheduler");
    use_channels_last(*networks.unet);
    use_channels_last(*networks.vae);
    check_text_fit(folder, text, networks.unet->config());
    check_latents_fit(folder, networks);
    return networks;
}

}  // namespace item3d
