#include "item3d/networks/vision_language/captioner.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/blip2.h"
#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/text/bert_tokenizer.h"
#include "item3d/text/gpt2_tokenizer.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;

void check_tokenizer(const fs::path& file, const CaptionTokenizer& tokenizer, int vocab_size) {
    if (tokenizer.largest_id() >= vocab_size)
        throw InputError(file.string(),
                         fmt::format("has id {}, but the network knows {} tokens",
                                     tokenizer.largest_id(), vocab_size),
                         "use the tokenizer of this model");
}

DecodingOptions decoding_options(const CaptionOptions& options) {
    DecodingOptions result;
    result.beams = options.beams;
    result.max_new_tokens = options.max_new_tokens;
    result.together = options.together;
    return result;
}

at::Tensor row(const std::vector<int>& ids) {
    return at::tensor(std::vector<std::int64_t>(ids.begin(), ids.end())).unsqueeze(0);
}

/// Returns the text of each decoded sequence from token `begin` on. A sequence ends with
/// `end_token` unless it was truncated.
std::vector<Caption> texts_of(const CaptionTokenizer& tokenizer, const Decoded& decoded, int begin,
                              int prompt_length, int end_token) {
    std::vector<Caption> captions;
    for (const at::Tensor& row : decoded.tokens.unbind(0)) {
        const at::Tensor tokens = row.contiguous();
        const auto* first = tokens.const_data_ptr<std::int64_t>();
        const auto* last = first + tokens.numel();
        std::string text = tokenizer.decode(std::vector<int>(first + begin, last));
        std::replace_if(
            text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
        captions.push_back({strip_white_space(to_valid_utf8(text)),
                            std::find(first + prompt_length, last, end_token) != last});
    }
    return captions;
}

at::Tensor process_all(const ImageProcessor& processor, const std::vector<at::Tensor>& images) {
    std::vector<at::Tensor> rows;
    for (const at::Tensor& image : images)
        rows.push_back(processor.process(image));
    return at::cat(rows);
}

class BlipCaptioner : public Captioner {
  public:
    BlipCaptioner(const fs::path& folder, const BlipConfig& config, at::Device device,
                  at::ScalarType dtype)
        : tokenizer_(BertTokenizer::load(folder)),
          processor_(ImageProcessor::load(folder, config.vision.image_size)),
          device_(device) {
        // All small files are read and checked before gigabytes of weights.
        check_tokenizer(folder / "vocab.txt", tokenizer_, config.vocab_size);
        const bool packs = PackedMatrix::runs(device, dtype);
        model_ = load_blip(folder, device, packs ? at::kFloat : dtype);
        if (packs) model_->pack(dtype);
    }
    std::vector<Caption> captions(const std::vector<at::Tensor>& images,
                                  const CaptionOptions& options) const override {
        // The network's own first token replaces [CLS], and [SEP] is dropped.
        std::vector<int> prompt = tokenizer_.encode(options.prefix);
        prompt.front() = model_->config().bos_token_id;
        prompt.pop_back();
        const Decoded decoded = write_captions(model_, process_all(processor_, images).to(device_),
                                               row(prompt), decoding_options(options));
        return texts_of(tokenizer_, decoded, 1, static_cast<int>(prompt.size()),
                        model_->config().sep_token_id);
    }

  private:
    BertTokenizer tokenizer_;
    ImageProcessor processor_;
    at::Device device_;
    BlipModel model_{nullptr};
};

class Blip2Captioner : public Captioner {
  public:
    Blip2Captioner(const fs::path& folder, const Blip2Config& config, at::Device device,
                   at::ScalarType dtype)
        : tokenizer_(Gpt2Tokenizer::load(folder)),
          processor_(ImageProcessor::load(folder, config.vision.image_size)),
          end_token_(config.text.eos_token_id),
          device_(device) {
        check_tokenizer(folder / "vocab.json", tokenizer_, config.text.vocab_size);
        const fs::path generation = folder / "generation_config.json";
        if (fs::exists(generation))
            end_token_ = Config::read(generation).integers("eos_token_id", {end_token_}).front();
        model_ = load_blip2(folder, device, dtype);
    }
    std::vector<Caption> captions(const std::vector<at::Tensor>& images,
                                  const CaptionOptions& options) const override {
        const Blip2Config& config = model_->config();
        std::vector<int> prompt(config.num_query_tokens, config.image_token_index);
        for (const int id : tokenizer_.encode(options.prefix))
            if (id != config.image_token_index) prompt.push_back(id);
        DecodingOptions decoding = decoding_options(options);
        decoding.end_token = end_token_;
        const Decoded decoded = write_captions(model_, process_all(processor_, images).to(device_),
                                               row(prompt), {}, decoding);
        return texts_of(tokenizer_, decoded, config.num_query_tokens,
                        static_cast<int>(prompt.size()), end_token_);
    }

  private:
    Gpt2Tokenizer tokenizer_;
    ImageProcessor processor_;
    int end_token_;
    at::Device device_;
    Blip2Model model_{nullptr};
};

}  // namespace

std::unique_ptr<Captioner> load_captioner(const fs::path& folder, at::Device device,
                                          at::ScalarType dtype) {
    const Config config = Config::read(folder / "config.json");
    const auto names = config.texts("architectures", {});
    const std::string name = names.empty() ? "" : names.front();
    if (name == "BlipForConditionalGeneration")
        return std::make_unique<BlipCaptioner>(folder, BlipConfig::from_config(config), device,
                                               dtype);
    if (name == "Blip2ForConditionalGeneration")
        return std::make_unique<Blip2Captioner>(folder, Blip2Config::from_config(config), device,
                                                dtype);
    config.fail("architectures", "BlipForConditionalGeneration or Blip2ForConditionalGeneration");
}

}  // namespace item3d
