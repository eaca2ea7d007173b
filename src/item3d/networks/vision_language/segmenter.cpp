#include "item3d/networks/vision_language/segmenter.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/vision_language/clip_seg.h"

#include <algorithm>

namespace item3d {
namespace {

/// Throws InputError unless the processor's image size is a multiple of the patch size. It may
/// differ from config.json's image_size, because the network interpolates its positions.
void check_patches(const std::filesystem::path& folder, const ImageProcessor& processor,
                   int patch) {
    for (const int width : {64, 128}) {
        const auto [h, w] = processor.output_size(64, width);
        if (h % patch != 0 || w % patch != 0)
            throw InputError(
                (folder / "preprocessor_config.json").string(),
                fmt::format("makes images of {} x {} pixels, which patches of {} do not divide", w,
                            h, patch),
                "the size must be a multiple of config.json's patch_size");
    }
}

}  // namespace

Segmenter Segmenter::load(const std::filesystem::path& folder, at::Device device,
                          at::ScalarType dtype) {
    // Reads small files first, so that their errors are found before gigabytes are read.
    const auto config = ClipSegConfig::from_config(Config::read(folder / "config.json"));
    Segmenter segmenter;
    segmenter.device_ = device;
    segmenter.tokenizer_ = std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder));
    segmenter.processor_ = std::make_shared<ImageProcessor>(ImageProcessor::load(folder));
    check_patches(folder, *segmenter.processor_, config.clip.vision.patch_size);
    if (segmenter.tokenizer_->largest_id() >= config.clip.text.vocab_size)
        throw InputError(
            (folder / "vocab.json").string(),
            fmt::format("has id {}, but the text model knows {} tokens",
                        segmenter.tokenizer_->largest_id(), config.clip.text.vocab_size),
            "use the tokenizer of this model");
    segmenter.model_ = load_clip_seg(folder, device, dtype).ptr();
    return segmenter;
}

Segmenter Segmenter::load_to_run(const std::filesystem::path& folder, at::Device device,
                                 at::ScalarType dtype) {
    const bool packs = PackedMatrix::runs(device, dtype);
    Segmenter segmenter = load(folder, device, packs ? at::kFloat : dtype);
    if (packs) pack_linear_layers(*segmenter.model_, dtype);
    return segmenter;
}

int Segmenter::text_length() const {
    return std::min(tokenizer_->model_max_length(),
                    model_->config().clip.text.max_position_embeddings);
}

void Segmenter::warn_of_lost_words(const std::string& subject, const std::string& prompt) const {
    item3d::warn_of_lost_words(*tokenizer_, subject, prompt, text_length());
}

at::Tensor Segmenter::segment(const at::Tensor& images,
                              const std::vector<std::string>& prompts) const {
    ITEM3D_CHECK(!prompts.empty(), "a segmenter needs prompts");
    at::Tensor embeddings;
    {
        const at::NoGradGuard no_grad;
        embeddings = model_->conditional_embeddings(
            tokenizer_->encode_batch(prompts, text_length()).to(device_));
    }
    const at::Tensor pixel_values = processor_->process_differentiably(images.to(device_));
    return model_->forward(pixel_values, embeddings).to(at::kFloat);
}

at::Tensor Segmenter::masks(const at::Tensor& images,
                            const std::vector<std::string>& prompts) const {
    const at::Tensor logits = segment(images, prompts);
    return at::sigmoid(at::upsample_bilinear2d(logits, {images.size(2), images.size(3)}, false));
}

}  // namespace item3d
