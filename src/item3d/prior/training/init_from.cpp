#include "item3d/prior/training/init_from.h"

#include "item3d/core/config.h"
#include "item3d/core/error.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/training/settings.h"
#include "item3d/prior/training/train_autoencoder.h"
#include "item3d/prior/training/train_captioner.h"
#include "item3d/prior/training/train_clip.h"
#include "item3d/prior/training/train_diffusion.h"
#include "item3d/text/bert_tokenizer.h"
#include "item3d/text/clip_tokenizer.h"

#include <limits>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr const char* another_size = "is for a network of a different size than in this training";
constexpr const char* size_hint =
    "use the --widths, --resolution and --condition that the prior was trained with";
constexpr const char* reader_hint = "train this part without --init-from";

/// Pads a U-Net's input weights with 0 for channels that only `to` has, so that its output is
/// unchanged.
at::Tensor with_more_inputs(const at::Tensor& weight, const at::Tensor& to) {
    const std::int64_t more = to.size(1) - weight.size(1);
    return more > 0 ? at::constant_pad_nd(weight, {0, 0, 0, 0, 0, more}) : weight;
}

/// Copies weights. kept_inputs: number of the U-Net's first input channels whose weights are
/// copied.
void copy_weights(const fs::path& folder, const torch::nn::Module& from, torch::nn::Module& to,
                  const char* hint = size_hint,
                  std::int64_t kept_inputs = std::numeric_limits<std::int64_t>::max()) {
    const at::NoGradGuard no_grad;
    auto given = from.named_parameters();
    auto wanted = to.named_parameters();
    if (at::Tensor* input = given.find("conv_in.weight"))
        *input = with_more_inputs(input->slice(1, 0, kept_inputs), wanted["conv_in.weight"]);
    bool fits = given.size() == wanted.size();
    for (const auto& item : wanted) {
        const at::Tensor* value = given.find(item.key());
        fits = fits && value && value->sizes() == item.value().sizes();
    }
    if (!fits) throw InputError(folder.string(), another_size, hint);
    for (auto& item : wanted)
        item.value().copy_(given[item.key()]);
}

void check_not_overwritten(const fs::path& taken, const TrainSettings& settings) {
    if (fs::exists(settings.output) && fs::equivalent(taken, settings.output))
        throw InputError(settings.output.string(), "must not be the output folder of the training",
                         "choose another folder with -o");
}

}  // namespace

void check_init_from(const TrainSettings& settings) {
    if (!settings.autoencoder.empty()) {
        if (!settings.init_from.empty())
            throw InputError("--autoencoder", "the prior of --init-from already has an autoencoder",
                             "use only one of --init-from and --autoencoder");
        check_not_overwritten(settings.autoencoder, settings);
        init_from_autoencoder(settings.autoencoder, settings.resolution);
    }
    if (settings.init_from.empty()) return;
    check_not_overwritten(settings.init_from, settings);
    const fs::path file = settings.init_from / "unet" / "config.json";
    auto given = UNet2DConditionConfig::from_config(Config::read(file));
    const UNet2DConditionConfig wanted = prior_unet_config(settings);
    if (given.in_channels < wanted.in_channels || settings.condition == image_condition)
        given.in_channels = wanted.in_channels;
    if (given.to_json() != wanted.to_json())
        throw InputError(file.string(), another_size, size_hint);
    init_from_autoencoder(settings.init_from, settings.resolution);
}

std::shared_ptr<AutoencoderTiny> init_from_autoencoder(const fs::path& folder, int resolution) {
    const auto model = std::dynamic_pointer_cast<AutoencoderTiny>(load_autoencoder(folder / "vae"));
    AutoencoderTinyConfig wanted = prior_autoencoder_config(resolution);
    if (model) wanted.scaling_factor = model->scaling_factor();
    if (!model || model->config_json() != wanted.to_json())
        throw InputError((folder / "vae").string(),
                         "is not an autoencoder that fits the data of this training",
                         "use a prior of `item3d prior train`, and its --resolution");
    return model;
}

nlohmann::json autoencoder_record(const fs::path& folder) {
    const nlohmann::json train = read_prior_json(folder).value("train", nlohmann::json());
    nlohmann::json record = nlohmann::json::object();
    for (const char* name : {"psnr", "object_psnr"})
        if (train.is_object() && train.contains(name)) record[name] = train.at(name);
    return record;
}

nlohmann::json init_from_record(const fs::path& folder) {
    nlohmann::json record = autoencoder_record(folder);
    const nlohmann::json train = read_prior_json(folder).value("train", nlohmann::json());
    if (train.is_object()) record["begun_with"] = train;
    return record;
}

void init_from_weights(const fs::path& folder, UNet2DCondition& unet, ClipTextModel& text,
                       bool by_images) {
    const UNet2DCondition given = load_unet(folder / "unet");
    const bool new_inputs = by_images && given->config().in_channels != unet->config().in_channels;
    copy_weights(folder / "unet", *given, *unet, size_hint,
                 new_inputs ? given->config().out_channels : given->config().in_channels);
    copy_weights(folder / "text_encoder", *load_clip_text(folder / "text_encoder"), *text);
}

fs::path init_from_part(const TrainSettings& settings, const char* part) {
    if (settings.init_from.empty()) return {};
    const fs::path folder = settings.init_from / part;
    return fs::exists(folder / "config.json") ? folder : fs::path{};
}

// All files are read once here, so that no error appears after the images are drawn.
void check_init_from_readers(const TrainSettings& settings, bool clip, bool captioner) {
    if (settings.init_from.empty()) return;
    check_not_overwritten(settings.init_from, settings);
    const auto check = [](const fs::path& folder, const auto& given, const auto& wanted) {
        if (given.to_json() != wanted.to_json())
            throw InputError((folder / "config.json").string(), another_size, reader_hint);
    };
    if (const fs::path folder = init_from_part(settings, captioner_folder);
        captioner && !folder.empty()) {
        const BlipModel given = load_blip(folder);
        BlipConfig wanted = prior_captioner_config(0);
        wanted.vocab_size = given->config().vocab_size;
        check(folder, given->config(), wanted);
        BertTokenizer::load(folder);
    }
    if (const fs::path folder = init_from_part(settings, clip_folder); clip && !folder.empty()) {
        const ClipModel given = load_clip_model(folder);
        const ClipTextConfig& text = given->config().text;
        check(folder, given->config(),
              prior_clip_config(text.vocab_size, text.bos_token_id, text.eos_token_id));
        ClipTokenizer::load(folder);
    }
}

void init_from_captioner(const fs::path& folder, BlipModel& model) {
    copy_weights(folder, *load_blip(folder), *model, reader_hint);
}

void init_from_clip(const fs::path& folder, ClipModel& model) {
    copy_weights(folder, *load_clip_model(folder), *model, reader_hint);
}

void init_from_segmenter(const fs::path& folder, ClipSegModel& model) {
    copy_weights(folder, *load_clip_seg(folder), *model, reader_hint);
}

}  // namespace item3d
