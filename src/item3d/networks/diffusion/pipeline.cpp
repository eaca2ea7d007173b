#include "item3d/networks/diffusion/pipeline.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/networks/layers/row_groups.h"
#include "item3d/tensors/weights.h"

#include <ATen/autocast_mode.h>
#include <malloc.h>

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Original height and width, top and left of the crop, target height and width.
constexpr int picture_sizes = 6;

/// False where model_index.json leaves a part out or says [null, null].
bool names_part(const Config& index, const std::string& part) {
    if (!index.has(part)) return false;
    const auto& entry = index.json().at(part);
    return !entry.is_array() || entry.empty() || !entry[0].is_null();
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

nlohmann::json model_index(const Pipeline& pipeline) {
    nlohmann::json index = {
        {"_class_name", "StableDiffusionPipeline"},
        {"feature_extractor", {nullptr, nullptr}},
        {"image_encoder", {nullptr, nullptr}},
        {"requires_safety_checker", false},
        {"safety_checker", {nullptr, nullptr}},
        {"scheduler", {"diffusers", pipeline.scheduler.config().to_json().at("_class_name")}},
        {"text_encoder", {"transformers", "CLIPTextModel"}},
        {"tokenizer", {"transformers", "CLIPTokenizer"}},
        {"unet", {"diffusers", "UNet2DConditionModel"}},
        {"vae", {"diffusers", pipeline.vae->config_json().at("_class_name")}},
    };
    if (pipeline.is_sdxl()) {
        index["_class_name"] = "StableDiffusionXLPipeline";
        index["text_encoder_2"] = {"transformers", "CLIPTextModelWithProjection"};
        index["tokenizer_2"] = {"transformers", "CLIPTokenizer"};
        index["force_zeros_for_empty_prompt"] = pipeline.force_zeros_for_empty_prompt;
        index.erase("requires_safety_checker");
        index.erase("safety_checker");
    }
    return index;
}

void write_json(const fs::path& path, const nlohmann::json& json) {
    write_atomically(path, json.dump(2) + "\n");
}

}  // namespace

void use_channels_last(torch::nn::Module& module) {
    for (const auto& layer : module.modules()) {
        const auto* convolution = layer->as<Conv3x3>();
        if (convolution && convolution->runs_from_file()) continue;
        for (torch::Tensor& parameter : layer->parameters(/*recurse=*/false))
            if (parameter.dim() == 4)
                parameter.set_data(parameter.contiguous(torch::MemoryFormat::ChannelsLast));
    }
}

Pipeline Pipeline::load(const fs::path& folder, torch::Device device, torch::Dtype dtype) {
    Pipeline pipeline = load_text(folder, device);
    pipeline.load_networks(folder, device, dtype);
    return pipeline;
}

Pipeline Pipeline::load_text(const fs::path& folder, torch::Device device) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "no such folder",
                         "name a folder in the diffusers layout (it holds model_index.json)");
    const Config index = Config::read(folder / "model_index.json");
    const bool sdxl = names_part(index, "text_encoder_2");
    check_part(index, "text_encoder", {"CLIPTextModel"});
    check_part(index, "tokenizer", {"CLIPTokenizer", "CLIPTokenizerFast"});
    check_part(index, "unet", {"UNet2DConditionModel"});
    check_part(index, "vae", {"AutoencoderKL", "AutoencoderTiny"});

    Pipeline pipeline;
    pipeline.tokenizer = std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder / "tokenizer"));
    pipeline.text_encoder = load_clip_text(folder / "text_encoder", device);
    if (sdxl) {
        check_part(index, "text_encoder_2", {"CLIPTextModelWithProjection"});
        check_part(index, "tokenizer_2", {"CLIPTokenizer", "CLIPTokenizerFast"});
        pipeline.tokenizer_2 =
            std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder / "tokenizer_2"));
        pipeline.text_encoder_2 = load_clip_text(folder / "text_encoder_2", device);
        pipeline.force_zeros_for_empty_prompt = index.boolean("force_zeros_for_empty_prompt", true);
    }
    pipeline.check_tokenizers_fit(folder);
    return pipeline;
}

void Pipeline::load_networks(const fs::path& folder, torch::Device device, torch::Dtype dtype,
                             bool with_decoder, WeightUse use) {
    unet = load_unet(folder / "unet", device, dtype, use);
    vae = load_autoencoder(folder / "vae", device, dtype, with_decoder, use);
    scheduler = NoiseSchedule::load(folder / "scheduler");
    use_channels_last(*unet);
    use_channels_last(*vae);
    check_fit(folder);
}

namespace {

[[noreturn]] void mismatch(const fs::path& folder, const std::string& part,
                           const std::string& problem) {
    throw InputError((folder / part / "config.json").string(), problem,
                     "the folder mixes parts of different models");
}

void check_tokenizer_fit(const fs::path& folder, const std::string& part,
                         const ClipTokenizer& tokenizer, const ClipTextConfig& text) {
    if (tokenizer.model_max_length() > text.max_position_embeddings)
        mismatch(folder, part,
                 fmt::format("max_position_embeddings is {}, but the tokenizer pads to {}",
                             text.max_position_embeddings, tokenizer.model_max_length()));
    if (tokenizer.largest_id() >= text.vocab_size)
        mismatch(folder, part,
                 fmt::format("vocab_size is {}, but the tokenizer has an id {}", text.vocab_size,
                             tokenizer.largest_id()));
}

}  // namespace

void Pipeline::check_fit(const fs::path& folder) const {
    check_text_fit(folder);
    const UNet2DConditionConfig& config = unet->config();
    if (config.out_channels != vae->latent_channels() ||
        config.in_channels < vae->latent_channels())
        mismatch(folder, "unet",
                 fmt::format("{} to {} channels do not fit the VAE's {} latent channels",
                             config.in_channels, config.out_channels, vae->latent_channels()));
}

void Pipeline::check_tokenizers_fit(const fs::path& folder) const {
    check_tokenizer_fit(folder, "text_encoder", *tokenizer, text_encoder->config());
    if (!is_sdxl()) return;
    const ClipTextConfig& second = text_encoder_2->config();
    if (!second.with_projection)
        mismatch(folder, "text_encoder_2",
                 "architectures must be CLIPTextModelWithProjection for SDXL");
    check_tokenizer_fit(folder, "text_encoder_2", *tokenizer_2, second);
    if (tokenizer_2->model_max_length() != tokenizer->model_max_length())
        mismatch(folder, "text_encoder_2", "the two tokenizers pad to different lengths");
}

void Pipeline::check_text_fit(const fs::path& folder) const {
    int width_given = text_encoder->config().hidden_size;
    int added = 0;
    if (is_sdxl()) {
        const ClipTextConfig& second = text_encoder_2->config();
        width_given += second.hidden_size;
        added = second.projection_dim;
    }
    const UNet2DConditionConfig& config = unet->config();
    for (const int width : config.cross_attention_dim)
        if (width != width_given)
            mismatch(folder, "unet",
                     fmt::format("cross_attention_dim is {}, but the text gives {}", width,
                                 width_given));
    if (config.addition_embed_type.empty() == is_sdxl())
        mismatch(folder, "unet",
                 is_sdxl() ? "SDXL's needs addition_embed_type text_time"
                           : "addition_embed_type needs a second text encoder (SDXL)");
    added += picture_sizes * config.addition_time_embed_dim;
    if (is_sdxl() && config.projection_class_embeddings_input_dim != added)
        mismatch(folder, "unet",
                 fmt::format("projection_class_embeddings_input_dim is {}, but pooled text and {} "
                             "picture sizes give {}",
                             config.projection_class_embeddings_input_dim, picture_sizes, added));
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
    if (is_sdxl()) {
        for (const char* part : {"text_encoder_2", "tokenizer_2"})
            make_output_folder(folder / part);
        save_clip_text(folder / "text_encoder_2", text_encoder_2, dtype);
        tokenizer_2->save(folder / "tokenizer_2");
    }
    write_json(folder / "model_index.json", model_index(*this));
}

void Pipeline::keep_texts(const std::vector<std::string>& prompts) {
    std::vector<std::string> all = prompts;
    all.emplace_back();
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    const TextEmbedding texts = encode_text(all);
    for (std::size_t i = 0; i < all.size(); ++i)
        encoded_[all[i]] = texts.row(static_cast<std::int64_t>(i));
    for (ClipTextModel* encoder : {&text_encoder, &text_encoder_2}) {
        if (encoder->is_empty()) continue;
        for (torch::Tensor& parameter : (*encoder)->parameters())
            parameter.set_data(torch::empty({0}, parameter.options()));
    }
    // What was let go lies in pieces between what stays; the system gets whole pages of it back.
    malloc_trim(0);
}

void Pipeline::give_up_weights() {
    std::vector<std::shared_ptr<torch::nn::Module>> networks{unet.ptr(), vae};
    if (!controlnet.is_empty()) networks.push_back(controlnet.ptr());
    for (const auto& network : networks)
        for (const auto& layer : network->modules())
            if (auto* convolution = layer->as<Conv3x3>()) convolution->give_up_weights();
    malloc_trim(0);
}

TextEmbedding Pipeline::encode_text(const std::vector<std::string>& prompts) const {
    if (!encoded_.empty()) {
        TextEmbedding known;
        for (const std::string& prompt : prompts) {
            const auto found = encoded_.find(prompt);
            ITEM3D_CHECK(found != encoded_.end(), "'" + prompt + "' was not encoded in time");
            known =
                known.states.defined() ? TextEmbedding::join(known, found->second) : found->second;
        }
        return known;
    }
    const torch::NoGradGuard no_grad;
    ClipTextModel model = text_encoder;
    const torch::Device place = text_encoder->parameters()[0].device();
    const ClipTextOutput first = model(tokenizer->encode_batch(prompts).to(place));
    if (!is_sdxl()) return {first.last_hidden_state};
    ClipTextModel model_2 = text_encoder_2;
    const ClipTextOutput second = model_2(tokenizer_2->encode_batch(prompts).to(place));
    const auto last_but_one = [](const ClipTextOutput& output) {
        return output.hidden_states[output.hidden_states.size() - 2];
    };
    return {torch::cat({last_but_one(first), last_but_one(second)}, 2), second.text_embeds};
}

TextEmbedding Pipeline::encode_no_text() const {
    const TextEmbedding text = encode_text({""});
    if (!force_zeros_for_empty_prompt) return text;
    return {torch::zeros_like(text.states),
            text.pooled.defined() ? torch::zeros_like(text.pooled) : torch::Tensor()};
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

namespace {

/// Networks on the CPU that only run, and whose operations are short.
bool runs_in_row_groups(const UNet2DConditionImpl& unet) {
    constexpr std::int64_t most_weights = 50'000'000;
    std::int64_t weights = 0;
    for (const torch::Tensor& parameter : unet.parameters()) {
        if (!parameter.is_cpu() || parameter.requires_grad()) return false;
        weights += parameter.numel();
    }
    return weights <= most_weights && !at::autocast::is_autocast_enabled(at::kCPU);
}

}  // namespace

torch::Tensor Pipeline::predict(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                                const TextEmbedding& text, const torch::Tensor& condition) const {
    const auto rows = noisy_latents.size(0);
    torch::Tensor sample = noisy_latents;
    const TextEmbedding each = text.expand(rows);
    AddedCondition added;
    if (is_sdxl()) added = {each.pooled, sizes_of(noisy_latents)};
    UNetResiduals residuals;
    if (!controlnet.is_empty() && condition.defined()) {
        ControlNet network = controlnet;
        residuals = network(sample, timesteps, each.states, condition.expand({rows, -1, -1, -1}),
                            controlnet_scale, added);
    }
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
    const auto run = [&](const torch::Tensor& samples, const torch::Tensor& times,
                         const torch::Tensor& states) {
        return network
            ->forward(samples.contiguous(torch::MemoryFormat::ChannelsLast), times, states, added,
                      residuals)
            .to(torch::kFloat32);
    };
    const bool alone = added.text_embeds.defined() || residuals.mid.defined() ||
                       sample.requires_grad() || !runs_in_row_groups(*unet);
    if (rows == 1 || alone) return run(sample, timesteps, each.states);
    const torch::Tensor times = timesteps.expand({rows});
    return in_row_groups(each.states, [&](auto first, auto count, const torch::Tensor& states) {
        return run(sample.narrow(0, first, count), times.narrow(0, first, count), states);
    });
}

torch::Tensor Pipeline::sizes_of(const torch::Tensor& latents) const {
    const auto height = static_cast<float>(latents.size(2) * downscale());
    const auto width = static_cast<float>(latents.size(3) * downscale());
    return torch::tensor({height, width, 0.0f, 0.0f, height, width})
        .to(latents.device())
        .expand({latents.size(0), picture_sizes});
}

torch::Tensor Pipeline::predict_noise(const torch::Tensor& noisy_latents,
                                      const torch::Tensor& timesteps, const TextEmbedding& text,
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
