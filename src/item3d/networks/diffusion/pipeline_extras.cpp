#include "item3d/networks/diffusion/pipeline_extras.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/diffusion/adapter_file.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/lora.h"
#include "item3d/networks/diffusion/textual_inversion.h"
#include "item3d/networks/layers/load_parameters.h"

#include <charconv>
#include <cmath>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns the file of the weights in a folder of PEFT or diffusers, or a path that is not a folder
/// itself. Throws InputError for other folders.
fs::path lora_in(const fs::path& path) {
    std::error_code too_long;
    if (!fs::is_directory(path, too_long)) return path;
    for (const char* name : {"adapter_model.safetensors", "pytorch_lora_weights.safetensors"})
        if (fs::exists(path / name)) return path / name;
    throw InputError(
        path.string(),
        "contains neither adapter_model.safetensors nor pytorch_lora_weights.safetensors",
        "give the LoRA's .safetensors file");
}

LoraFile parse_lora(const std::string& argument) {
    const AdapterArgument parts = split_adapter_argument(argument);
    LoraFile result{lora_in(parts.file), 1};
    if (parts.rest.empty()) return result;
    const char* end = parts.rest.data() + parts.rest.size();
    const auto read = std::from_chars(parts.rest.data(), end, result.scale);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(result.scale))
        throw InputError("--lora " + argument, fmt::format("'{}' is not a number", parts.rest),
                         "write FILE or FILE:SCALE, as in style.safetensors:0.8");
    return result;
}

void replace_vae(DiffusionNetworks& networks, const fs::path& folder, bool with_decoder) {
    const auto dtype = networks.vae->parameters()[0].scalar_type();
    const auto vae = load_autoencoder(folder, networks.device(), dtype, with_decoder);
    const auto reject = [&](const std::string& problem) {
        throw InputError((folder / "config.json").string(), problem,
                         "use an autoencoder that was made for this model");
    };
    if (vae->latent_channels() != networks.latent_channels())
        reject(fmt::format("has {} latent channels, the model's own has {}", vae->latent_channels(),
                           networks.latent_channels()));
    if (vae->downscale() != networks.vae->downscale())
        reject(
            fmt::format("has one latent cell per {0}x{0} pixels, the model's own one per {1}x{1}",
                        vae->downscale(), networks.vae->downscale()));
    use_channels_last(*vae);
    networks.vae = vae;
}

/// Throws InputError if a ControlNet's residuals do not fit the U-Net's feature maps.
void check_fit(const ControlNetConfig& control, const DiffusionNetworks& networks,
               const fs::path& folder) {
    const auto require = [&](bool fits, const std::string& problem) {
        if (!fits)
            throw InputError((folder / "config.json").string(), problem,
                             "use a depth ControlNet that was made for this model");
    };
    const UNet2DConditionConfig& unet = networks.unet->config();
    require(networks.condition_channels() == 0,
            fmt::format("the model's U-Net has {} additional input channels and cannot be combined "
                        "with a ControlNet",
                        networks.condition_channels()));
    require(control.conditioning_channels == 3,
            fmt::format("conditioning_channels is {}, expected 3", control.conditioning_channels));
    require(control.downscale() == networks.vae->downscale(),
            fmt::format("has {} pixels per latent cell, the model's autoencoder {}",
                        control.downscale(), networks.vae->downscale()));
    require(
        control.in_channels == unet.in_channels,
        fmt::format("in_channels is {}, the U-Net's is {}", control.in_channels, unet.in_channels));
    require(control.block_out_channels == unet.block_out_channels,
            fmt::format("block_out_channels is [{}], the U-Net's is [{}]",
                        fmt::join(control.block_out_channels, ", "),
                        fmt::join(unet.block_out_channels, ", ")));
    require(control.layers_per_block == unet.layers_per_block,
            "layers_per_block differs from the U-Net's");
    require(control.cross_attention_dim == unet.cross_attention_dim,
            fmt::format("cross_attention_dim is [{}], the U-Net's is [{}]",
                        fmt::join(control.cross_attention_dim, ", "),
                        fmt::join(unet.cross_attention_dim, ", ")));
    require(control.addition_embed_type == unet.addition_embed_type,
            "addition_embed_type differs from the U-Net's");
}

void add_controlnet(DiffusionNetworks& networks, const fs::path& folder, float scale) {
    if (!(scale >= 0 && scale <= max_controlnet_scale))
        throw InputError("--controlnet-scale",
                         fmt::format("must be between 0 and {}", max_controlnet_scale));
    const auto dtype = networks.unet->parameters()[0].scalar_type();
    networks.controlnet = load_controlnet(folder, networks.device(), dtype);
    check_fit(networks.controlnet->config(), networks, folder);
    use_channels_last(*networks.controlnet);
    networks.controlnet_scale = scale;
}

}  // namespace

void fuse_loras(const PipelineExtras& extras, TextEncoders& text, DiffusionNetworks& networks) {
    if (extras.lora.empty()) return;
    std::vector<LoraFile> files;
    for (const std::string& argument : extras.lora)
        files.push_back(parse_lora(argument));
    fuse_loras(files, {networks.unet, text.model, text.model_2});
}

void add_embeddings(const PipelineExtras& extras, TextEncoders& text) {
    std::vector<TextEncoderPair> encoders{{text.tokenizer, text.model}};
    if (text.is_sdxl()) encoders.push_back({text.tokenizer_2, text.model_2});
    for (const std::string& argument : extras.embedding) {
        const AdapterArgument parts = split_adapter_argument(argument);
        add_embedding(parts.file, parts.rest, encoders);
    }
}

void change_networks(const PipelineExtras& extras, DiffusionNetworks& networks, bool with_decoder) {
    if (!extras.vae.empty()) replace_vae(networks, extras.vae, with_decoder);
    if (!extras.controlnet.empty())
        add_controlnet(networks, extras.controlnet, extras.controlnet_scale);
}

}  // namespace item3d
