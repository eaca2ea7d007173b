#include "item3d/prior/begin_with.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/prior/train.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

void copy_weights(const fs::path& folder, const torch::nn::Module& from, torch::nn::Module& to) {
    const torch::NoGradGuard no_grad;
    const auto given = from.named_parameters();
    auto wanted = to.named_parameters();
    bool fits = given.size() == wanted.size();
    for (const auto& item : wanted) {
        const torch::Tensor* value = given.find(item.key());
        fits = fits && value && value->sizes() == item.value().sizes();
    }
    if (!fits)
        throw InputError(folder.string(), "holds a network of another size than this training's",
                         "give the --widths, --resolution and --no-depth that it was trained with");
    for (auto& item : wanted)
        item.value().copy_(given[item.key()]);
}

}  // namespace

std::shared_ptr<AutoencoderTiny> begin_with_autoencoder(const fs::path& folder, int resolution) {
    const auto model = std::dynamic_pointer_cast<AutoencoderTiny>(load_autoencoder(folder / "vae"));
    AutoencoderTinyConfig wanted = prior_autoencoder_config(resolution);
    if (model) wanted.scaling_factor = model->scaling_factor();
    if (!model || model->config_json() != wanted.to_json())
        throw InputError((folder / "vae").string(),
                         "is not an autoencoder as this training's data needs it",
                         "begin with a prior that 'item3d prior train' made, and its --resolution");
    return model;
}

nlohmann::json begin_with_record(const fs::path& folder) {
    const fs::path file = folder / "prior.json";
    if (!fs::exists(file)) return nlohmann::json::object();
    const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
    if (!json.is_object() || !json.contains("train") || !json["train"].is_object())
        return nlohmann::json::object();
    nlohmann::json record{{"begun_with", json["train"]}};
    for (const char* name : {"psnr", "object_psnr"})
        if (json["train"].contains(name)) record[name] = json["train"][name];
    return record;
}

void begin_with_weights(const fs::path& folder, UNet2DCondition& unet, ClipTextModel& text) {
    copy_weights(folder / "unet", *load_unet(folder / "unet"), *unet);
    copy_weights(folder / "text_encoder", *load_clip_text(folder / "text_encoder"), *text);
}

}  // namespace item3d
