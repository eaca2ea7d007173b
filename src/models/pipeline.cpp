#include "item3d/models/pipeline.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/models/weights.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Convolution weights in the order that convolutions on channels-last maps want.
void use_channels_last(torch::nn::Module& module) {
    for (torch::Tensor& parameter : module.parameters())
        if (parameter.dim() == 4)
            parameter.set_data(parameter.contiguous(torch::MemoryFormat::ChannelsLast));
}

/// Throws unless model_index.json names a class that we know for `part`.
void check_part(const Config& index, const std::string& part,
                const std::vector<std::string>& classes) {
    std::string found = "nothing";
    if (index.has(part)) {
        const auto& entry = index.json().at(part);
        if (entry.is_array() && entry.size() == 2 && entry[1].is_string())
            found = entry[1].get<std::string>();
    }
    std::string wanted;
    for (const std::string& name : classes) {
        if (name == found) return;
        wanted += (wanted.empty() ? "" : " or ") + name;
    }
    index.reject(part, "expected " + wanted + ", found " + found);
}

nlohmann::json model_index(const Autoencoder& vae) {
    return {
        {"_class_name", "StableDiffusionPipeline"},
        {"feature_extractor", {nullptr, nullptr}},
        {"image_encoder", {nullptr, nullptr}},
        {"requires_safety_checker", false},
        {"safety_checker", {nullptr, nullptr}},
        {"scheduler", {"diffusers", "DDIMScheduler"}},
        {"text_encoder", {"transformers", "CLIPTextModel"}},
        {"tokenizer", {"transformers", "CLIPTokenizer"}},
        {"unet", {"diffusers", "UNet2DConditionModel"}},
        {"vae", {"diffusers", vae.config_json().at("_class_name")}},
    };
}

void write_json(const fs::path& path, const nlohmann::json& json) {
    write_atomically(path, json.dump(2) + "\n");
}

}  // namespace

Pipeline Pipeline::load(const fs::path& folder, torch::Device device, torch::Dtype dtype) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "no such folder",
                         "name a folder in the diffusers layout (it holds model_index.json)");
    const Config index = Config::read(folder / "model_index.json");
    if (index.has("text_encoder_2") && !index.json().at("text_encoder_2")[0].is_null())
        index.reject("text_encoder_2", "pipelines of two text encoders (SDXL) are not supported");
    check_part(index, "text_encoder", {"CLIPTextModel"});
    check_part(index, "tokenizer", {"CLIPTokenizer", "CLIPTokenizerFast"});
    check_part(index, "unet", {"UNet2DConditionModel"});
    check_part(index, "vae", {"AutoencoderKL", "AutoencoderTiny"});

    Pipeline pipeline;
    pipeline.tokenizer = std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder / "tokenizer"));
    pipeline.text_encoder = load_clip_text(folder / "text_encoder", device);
    pipeline.unet = load_unet(folder / "unet", device, dtype);
    pipeline.vae = load_autoencoder(folder / "vae", device, dtype);
    pipeline.scheduler = DdimScheduler::load(folder / "scheduler");
    use_channels_last(*pipeline.unet);
    use_channels_last(*pipeline.vae);
    pipeline.check_fit(folder);
    return pipeline;
}

void Pipeline::check_fit(const fs::path& folder) const {
    const auto mismatch = [&](const char* part, const std::string& problem) {
        throw InputError((folder / part / "config.json").string(), problem,
                         "the folder mixes parts of different models");
    };
    const ClipTextConfig& text = text_encoder->config();
    for (const int width : unet->config().cross_attention_dim)
        if (width != text.hidden_size)
            mismatch("unet", fmt::format("cross_attention_dim is {}, but the text encoder gives {}",
                                         width, text.hidden_size));
    if (unet->config().out_channels != vae->latent_channels() ||
        unet->config().in_channels < vae->latent_channels())
        mismatch("unet", fmt::format("{} to {} channels do not fit the VAE's {} latent channels",
                                     unet->config().in_channels, unet->config().out_channels,
                                     vae->latent_channels()));
    if (!unet->config().addition_embed_type.empty())
        mismatch("unet", "addition_embed_type needs a second text encoder (SDXL), not supported");
    if (tokenizer->model_max_length() > text.max_position_embeddings)
        mismatch("text_encoder",
                 fmt::format("max_position_embeddings is {}, but the tokenizer pads to {}",
                             text.max_position_embeddings, tokenizer->model_max_length()));
    if (tokenizer->largest_id() >= text.vocab_size)
        mismatch("text_encoder", fmt::format("vocab_size is {}, but the tokenizer has an id {}",
                                             text.vocab_size, tokenizer->largest_id()));
}

void save_unet(const fs::path& folder, const UNet2DCondition& unet, torch::Dtype dtype) {
    write_json(folder / "config.json", unet->config().to_json());
    save_safetensors(folder / "diffusion_pytorch_model.safetensors", module_tensors(*unet, dtype),
                     {{"format", "pt"}});
}

void save_autoencoder(const fs::path& folder, const Autoencoder& autoencoder, torch::Dtype dtype) {
    write_json(folder / "config.json", autoencoder.config_json());
    save_safetensors(folder / "diffusion_pytorch_model.safetensors",
                     module_tensors(autoencoder, dtype), {{"format", "pt"}});
}

void save_clip_text(const fs::path& folder, const ClipTextModel& model, torch::Dtype dtype) {
    write_json(folder / "config.json", model->config().to_json());
    save_safetensors(folder / "model.safetensors", published_tensors(model, dtype),
                     {{"format", "pt"}});
}

void Pipeline::save(const fs::path& folder, torch::Dtype dtype) const {
    make_output_folder(folder);
    for (const char* part : {"unet", "vae", "text_encoder", "tokenizer", "scheduler"})
        make_output_folder(folder / part);
    save_unet(folder / "unet", unet, dtype);
    save_autoencoder(folder / "vae", *vae, dtype);
    save_clip_text(folder / "text_encoder", text_encoder, dtype);
    tokenizer->save(folder / "tokenizer");
    write_json(folder / "scheduler" / "scheduler_config.json", scheduler.config().to_json());
    write_json(folder / "model_index.json", model_index(*vae));
}

torch::Tensor Pipeline::encode_text(const std::vector<std::string>& prompts) const {
    const torch::NoGradGuard no_grad;
    ClipTextModel model = text_encoder;
    return model(tokenizer->encode_batch(prompts).to(device())).last_hidden_state;
}

torch::Tensor Pipeline::encode_image(const torch::Tensor& images) const {
    const torch::Tensor latents =
        vae->encode(images.contiguous(torch::MemoryFormat::ChannelsLast)).to(torch::kFloat32);
    return (latents - vae->shift_factor()) * vae->scaling_factor();
}

torch::Tensor Pipeline::decode_image(const torch::Tensor& latents) const {
    const torch::Tensor unscaled = latents / vae->scaling_factor() + vae->shift_factor();
    return vae->decode(unscaled.contiguous(torch::MemoryFormat::ChannelsLast)).to(torch::kFloat32);
}

torch::Tensor Pipeline::predict(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                                const torch::Tensor& text, const torch::Tensor& condition) const {
    const auto rows = noisy_latents.size(0);
    torch::Tensor sample = noisy_latents;
    if (const int channels = condition_channels()) {
        torch::Tensor extra = condition;
        if (!extra.defined())
            extra = torch::zeros({1, channels, sample.size(2), sample.size(3)}, sample.options());
        ITEM3D_CHECK(extra.size(1) == channels && extra.size(2) == sample.size(2) &&
                         extra.size(3) == sample.size(3),
                     "the condition must be on the latents' grid");
        sample = torch::cat({sample, extra.to(sample.options()).expand({rows, -1, -1, -1})}, 1);
    }
    UNet2DCondition network = unet;
    return network(sample.contiguous(torch::MemoryFormat::ChannelsLast), timesteps,
                   text.size(0) == rows ? text : text.expand({rows, -1, -1}))
        .to(torch::kFloat32);
}

torch::Tensor Pipeline::predict_noise(const torch::Tensor& noisy_latents,
                                      const torch::Tensor& timesteps, const torch::Tensor& text,
                                      const torch::Tensor& condition) const {
    return scheduler.to_noise(predict(noisy_latents, timesteps, text, condition), noisy_latents,
                              timesteps);
}

int Pipeline::latent_channels() const {
    return vae->latent_channels();
}

int Pipeline::condition_channels() const {
    return unet->config().in_channels - vae->latent_channels();
}

int Pipeline::downscale() const {
    return vae->downscale();
}

torch::Device Pipeline::device() const {
    return unet->parameters()[0].device();
}

}  // namespace item3d
