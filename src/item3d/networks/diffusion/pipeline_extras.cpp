#include "item3d/networks/diffusion/pipeline_extras.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/diffusion/adapter_file.h"
#include "item3d/networks/diffusion/lora.h"
#include "item3d/networks/diffusion/textual_inversion.h"

#include <charconv>
#include <cmath>

namespace item3d {
namespace {

namespace fs = std::filesystem;

LoraFile parse_lora(const std::string& argument) {
    const AdapterArgument parts = split_adapter_argument(argument);
    LoraFile result{parts.file, 1};
    if (parts.rest.empty()) return result;
    const char* end = parts.rest.data() + parts.rest.size();
    const auto read = std::from_chars(parts.rest.data(), end, result.scale);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(result.scale))
        throw InputError("--lora " + argument, fmt::format("'{}' is not a number", parts.rest),
                         "write FILE or FILE:SCALE, as in style.safetensors:0.8");
    return result;
}

void add_loras(Pipeline& pipeline, const std::vector<std::string>& arguments) {
    if (arguments.empty()) return;
    std::vector<LoraFile> files;
    for (const std::string& argument : arguments)
        files.push_back(parse_lora(argument));
    fuse_loras(files, {pipeline.unet, pipeline.text_encoder, pipeline.text_encoder_2});
}

void add_embeddings(Pipeline& pipeline, const std::vector<std::string>& arguments) {
    std::vector<TextEncoderPair> encoders{{pipeline.tokenizer, pipeline.text_encoder}};
    if (pipeline.is_sdxl()) encoders.push_back({pipeline.tokenizer_2, pipeline.text_encoder_2});
    for (const std::string& argument : arguments) {
        const AdapterArgument parts = split_adapter_argument(argument);
        add_embedding(parts.file, parts.rest, encoders);
    }
}

void replace_vae(Pipeline& pipeline, const fs::path& folder, bool with_decoder) {
    const auto dtype = pipeline.vae->parameters()[0].scalar_type();
    const auto vae = load_autoencoder(folder, pipeline.device(), dtype, with_decoder);
    const auto reject = [&](const std::string& problem) {
        throw InputError((folder / "config.json").string(), problem,
                         "use an autoencoder that was made for this model");
    };
    if (vae->latent_channels() != pipeline.latent_channels())
        reject(fmt::format("has {} latent channels, the model's own has {}", vae->latent_channels(),
                           pipeline.latent_channels()));
    if (vae->downscale() != pipeline.downscale())
        reject(fmt::format("has a latent cell for {0}x{0} pixels, the model's own for {1}x{1}",
                           vae->downscale(), pipeline.downscale()));
    use_channels_last(*vae);
    pipeline.vae = vae;
}

/// Throws where a ControlNet's residuals would not fit the U-Net's feature maps.
void check_fit(const ControlNetConfig& control, const Pipeline& pipeline, const fs::path& folder) {
    const auto require = [&](bool fits, const std::string& problem) {
        if (!fits)
            throw InputError((folder / "config.json").string(), problem,
                             "use a depth ControlNet that was made for this model");
    };
    const UNet2DConditionConfig& unet = pipeline.unet->config();
    require(pipeline.condition_channels() == 0,
            fmt::format("the model's U-Net takes {} further channels, and no ControlNet beside",
                        pipeline.condition_channels()));
    require(control.conditioning_channels == 3,
            fmt::format("conditioning_channels is {}, expected a picture of 3",
                        control.conditioning_channels));
    require(control.downscale() == pipeline.downscale(),
            fmt::format("takes {} pixels for a latent cell, the model's autoencoder {}",
                        control.downscale(), pipeline.downscale()));
    require(
        control.in_channels == unet.in_channels,
        fmt::format("in_channels is {}, the U-Net's is {}", control.in_channels, unet.in_channels));
    require(control.block_out_channels == unet.block_out_channels,
            fmt::format("block_out_channels is [{}], the U-Net's is [{}]",
                        fmt::join(control.block_out_channels, ", "),
                        fmt::join(unet.block_out_channels, ", ")));
    require(control.layers_per_block == unet.layers_per_block,
            "layers_per_block is another than the U-Net's");
    require(control.cross_attention_dim == unet.cross_attention_dim,
            fmt::format("cross_attention_dim is [{}], the U-Net's is [{}]",
                        fmt::join(control.cross_attention_dim, ", "),
                        fmt::join(unet.cross_attention_dim, ", ")));
    require(control.addition_embed_type == unet.addition_embed_type,
            "addition_embed_type is another than the U-Net's");
}

void add_controlnet(Pipeline& pipeline, const fs::path& folder, float scale) {
    if (!(scale >= 0 && scale <= 10))
        throw InputError("--controlnet-scale", "must be between 0 and 10");
    const auto dtype = pipeline.unet->parameters()[0].scalar_type();
    pipeline.controlnet = load_controlnet(folder, pipeline.device(), dtype);
    check_fit(pipeline.controlnet->config(), pipeline, folder);
    use_channels_last(*pipeline.controlnet);
    pipeline.controlnet_scale = scale;
}

void change_networks(Pipeline& pipeline, const PipelineExtras& extras, bool with_decoder) {
    if (!extras.vae.empty()) replace_vae(pipeline, extras.vae, with_decoder);
    if (!extras.controlnet.empty())
        add_controlnet(pipeline, extras.controlnet, extras.controlnet_scale);
}

}  // namespace

void apply_extras(Pipeline& pipeline, const PipelineExtras& extras) {
    add_loras(pipeline, extras.lora);
    add_embeddings(pipeline, extras.embedding);
    change_networks(pipeline, extras, /*with_decoder=*/true);
}

Pipeline load_to_run(const std::filesystem::path& folder, torch::Device device, torch::Dtype dtype,
                     const PipelineExtras& extras, const RunNeeds& needs) {
    Pipeline pipeline = Pipeline::load_text(folder, device);
    const auto load_networks = [&](WeightUse use) {
        pipeline.load_networks(folder, device, dtype, needs.decoder, use);
    };
    if (!extras.lora.empty()) {
        load_networks(WeightUse::any);
        add_loras(pipeline, extras.lora);
    }
    add_embeddings(pipeline, extras.embedding);
    pipeline.keep_texts(needs.prompts);
    if (extras.lora.empty()) load_networks(WeightUse::running);
    change_networks(pipeline, extras, needs.decoder);
    pipeline.give_up_weights();
    return pipeline;
}

}  // namespace item3d
