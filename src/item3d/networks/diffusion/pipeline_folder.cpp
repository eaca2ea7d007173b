#include "item3d/networks/diffusion/pipeline_folder.h"

#include "item3d/core/config.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/layers/load_parameters.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns false if model_index.json omits a part or says [null, null].
bool names_part(const Config& index, const std::string& part) {
    if (!index.has(part)) return false;
    const auto& entry = index.json().at(part);
    return !entry.is_array() || entry.empty() || !entry[0].is_null();
}

/// Throws InputError unless model_index.json names a supported class for `part`.
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

void write_json(const fs::path& path, const nlohmann::json& json) {
    write_atomically(path, json.dump(2) + "\n");
}

}  // namespace

PipelineIndex PipelineIndex::read(const fs::path& folder) {
    if (!fs::is_directory(folder))
        throw InputError(folder.string(), "no such folder",
                         "give a folder in the diffusers layout (with model_index.json)");
    const Config index = Config::read(folder / "model_index.json");
    check_part(index, "text_encoder", {"CLIPTextModel"});
    check_part(index, "tokenizer", {"CLIPTokenizer", "CLIPTokenizerFast"});
    check_part(index, "unet", {"UNet2DConditionModel"});
    check_part(index, "vae", {"AutoencoderKL", "AutoencoderTiny"});
    if (!names_part(index, "text_encoder_2")) return {};
    check_part(index, "text_encoder_2", {"CLIPTextModelWithProjection"});
    check_part(index, "tokenizer_2", {"CLIPTokenizer", "CLIPTokenizerFast"});
    return {true, index.boolean("force_zeros_for_empty_prompt", true)};
}

void save_unet(const fs::path& folder, const UNet2DCondition& unet, at::ScalarType dtype) {
    write_json(folder / "config.json", unet->config().to_json());
    save_safetensors(folder / "diffusion_pytorch_model.safetensors", module_tensors(*unet, dtype),
                     {{"format", "pt"}});
}

void save_autoencoder(const fs::path& folder, const Autoencoder& autoencoder,
                      at::ScalarType dtype) {
    write_json(folder / "config.json", autoencoder.config_json());
    save_safetensors(folder / "diffusion_pytorch_model.safetensors",
                     module_tensors(autoencoder, dtype), {{"format", "pt"}});
}

void save_clip_text(const fs::path& folder, const ClipTextModel& model, at::ScalarType dtype) {
    write_json(folder / "config.json", model->config().to_json());
    save_safetensors(folder / "model.safetensors", published_tensors(model, dtype),
                     {{"format", "pt"}});
}

}  // namespace item3d
