#include "item3d/networks/diffusion/pipeline.h"

#include "item3d/core/files.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/pipeline_folder.h"

namespace item3d {
namespace {

nlohmann::json model_index(const TextEncoders& text, const DiffusionNetworks& networks,
                           bool force_zeros_for_empty_prompt) {
    nlohmann::json index = {
        {"_class_name", "StableDiffusionPipeline"},
        {"feature_extractor", {nullptr, nullptr}},
        {"image_encoder", {nullptr, nullptr}},
        {"requires_safety_checker", false},
        {"safety_checker", {nullptr, nullptr}},
        {"scheduler", {"diffusers", networks.scheduler.config().to_json().at("_class_name")}},
        {"text_encoder", {"transformers", "CLIPTextModel"}},
        {"tokenizer", {"transformers", "CLIPTokenizer"}},
        {"unet", {"diffusers", "UNet2DConditionModel"}},
        {"vae", {"diffusers", networks.vae->config_json().at("_class_name")}},
    };
    if (text.is_sdxl()) {
        index["_class_name"] = "StableDiffusionXLPipeline";
        index["text_encoder_2"] = {"transformers", "CLIPTextModelWithProjection"};
        index["tokenizer_2"] = {"transformers", "CLIPTokenizer"};
        index["force_zeros_for_empty_prompt"] = force_zeros_for_empty_prompt;
        index.erase("requires_safety_checker");
        index.erase("safety_checker");
    }
    return index;
}

}  // namespace

Pipeline Pipeline::load(const std::filesystem::path& folder, at::Device device,
                        at::ScalarType dtype) {
    const PipelineIndex index = PipelineIndex::read(folder);
    Pipeline pipeline;
    pipeline.text_ = std::make_shared<TextEncoders>(
        TextEncoders::load(folder, index.has_second_text_encoder, device));
    pipeline.tokenizer_ = pipeline.text_->tokenizer;
    pipeline.sdxl_ = index.has_second_text_encoder;
    pipeline.force_zeros_for_empty_prompt_ = index.force_zeros_for_empty_prompt;
    pipeline.networks_ = std::make_shared<DiffusionNetworks>(
        DiffusionNetworks::load(folder, *pipeline.text_, device, dtype));
    return pipeline;
}

void Pipeline::add(const PipelineExtras& extras) {
    fuse_loras(extras, *text_, *networks_);
    add_embeddings(extras, *text_);
    change_networks(extras, *networks_, /*with_decoder=*/true);
}

void Pipeline::save(const std::filesystem::path& folder, at::ScalarType dtype) const {
    make_output_folder(folder);
    for (const char* part : {"unet", "vae", "text_encoder", "tokenizer", "scheduler"})
        make_output_folder(folder / part);
    save_unet(folder / "unet", networks_->unet, dtype);
    save_autoencoder(folder / "vae", *networks_->vae, dtype);
    save_clip_text(folder / "text_encoder", text_->model, dtype);
    tokenizer_->save(folder / "tokenizer");
    write_atomically(folder / "scheduler" / "scheduler_config.json",
                     schedule().config().to_json().dump(2) + "\n");
    if (is_sdxl()) {
        for (const char* part : {"text_encoder_2", "tokenizer_2"})
            make_output_folder(folder / part);
        save_clip_text(folder / "text_encoder_2", text_->model_2, dtype);
        text_->tokenizer_2->save(folder / "tokenizer_2");
    }
    write_atomically(folder / "model_index.json",
                     model_index(*text_, *networks_, force_zeros_for_empty_prompt_).dump(2) + "\n");
}

TextEmbedding Pipeline::encode_text(const std::vector<std::string>& prompts) const {
    return text_->encode(prompts);
}

}  // namespace item3d
