#include "item3d/networks/vision_language/clip.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/vision_language/clip_model.h"

#include <algorithm>

namespace item3d {
namespace {

at::Tensor unit_length(const at::Tensor& features) {
    return features / features.norm(2, {-1}, /*keepdim=*/true).clamp_min(1e-12);
}

}  // namespace

Clip Clip::load(const std::filesystem::path& folder, at::Device device, at::ScalarType dtype) {
    // Reads small files first, so that their errors are found before gigabytes are read.
    const auto config = ClipConfig::from_config(Config::read(folder / "config.json"));
    Clip clip;
    clip.device_ = device;
    clip.tokenizer_ = std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder));
    clip.processor_ =
        std::make_shared<ImageProcessor>(ImageProcessor::load(folder, config.vision.image_size));
    if (clip.tokenizer_->largest_id() >= config.text.vocab_size)
        throw InputError((folder / "vocab.json").string(),
                         fmt::format("has id {}, but the text model knows {} tokens",
                                     clip.tokenizer_->largest_id(), config.text.vocab_size),
                         "use the tokenizer of this model");
    clip.model_ = load_clip_model(folder, device, dtype).ptr();
    return clip;
}

Clip Clip::load_to_run(const std::filesystem::path& folder, at::Device device,
                       at::ScalarType dtype) {
    const bool packs = PackedMatrix::runs(device, dtype);
    Clip clip = load(folder, device, packs ? at::kFloat : dtype);
    if (packs) pack_linear_layers(*clip.model_, dtype);
    return clip;
}

int Clip::text_length() const {
    return std::min(tokenizer_->model_max_length(), model_->config().text.max_position_embeddings);
}

void Clip::warn_of_lost_words(const std::string& subject, const std::string& text) const {
    item3d::warn_of_lost_words(*tokenizer_, subject, text, text_length());
}

at::Tensor Clip::embed_texts(const std::vector<std::string>& texts) const {
    const at::NoGradGuard no_grad;
    const at::Tensor ids = tokenizer_->encode_batch(texts, text_length()).to(device_);
    return unit_length(model_->text_features(ids).to(at::kFloat));
}

at::Tensor Clip::embed_images(const at::Tensor& images) const {
    const at::Tensor pixel_values = processor_->process_differentiably(images.to(device_));
    return unit_length(model_->image_features(pixel_values).to(at::kFloat));
}

}  // namespace item3d
