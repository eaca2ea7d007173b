#include "item3d/networks/diffusion/text_encoders.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void reject_text(const fs::path& folder, const std::string& part,
                              const std::string& problem) {
    throw InputError((folder / part / "config.json").string(), problem,
                     "the folder mixes parts of different models; get it again");
}

void check_tokenizer_fit(const fs::path& folder, const std::string& part,
                         const ClipTokenizer& tokenizer, const ClipTextConfig& text) {
    if (tokenizer.model_max_length() > text.max_position_embeddings)
        reject_text(folder, part,
                    fmt::format("max_position_embeddings is {}, but the tokenizer pads to {}",
                                text.max_position_embeddings, tokenizer.model_max_length()));
    if (tokenizer.largest_id() >= text.vocab_size)
        reject_text(folder, part,
                    fmt::format("vocab_size is {}, but the tokenizer has an id {}", text.vocab_size,
                                tokenizer.largest_id()));
}

void check_tokenizers_fit(const fs::path& folder, const TextEncoders& text) {
    check_tokenizer_fit(folder, "text_encoder", *text.tokenizer, text.model->config());
    if (!text.is_sdxl()) return;
    const ClipTextConfig& second = text.model_2->config();
    if (!second.with_projection)
        reject_text(folder, "text_encoder_2",
                    "architectures must be CLIPTextModelWithProjection for SDXL");
    check_tokenizer_fit(folder, "text_encoder_2", *text.tokenizer_2, second);
    if (text.tokenizer_2->model_max_length() != text.tokenizer->model_max_length())
        reject_text(folder, "text_encoder_2", "the two tokenizers pad to different lengths");
}

}  // namespace

TextEncoders TextEncoders::load(const fs::path& folder, bool with_second, at::Device device) {
    TextEncoders text;
    text.tokenizer = std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder / "tokenizer"));
    text.model = load_clip_text(folder / "text_encoder", device);
    if (with_second) {
        text.tokenizer_2 =
            std::make_shared<ClipTokenizer>(ClipTokenizer::load(folder / "tokenizer_2"));
        text.model_2 = load_clip_text(folder / "text_encoder_2", device);
    }
    check_tokenizers_fit(folder, text);
    return text;
}

TextEmbedding TextEncoders::encode(const std::vector<std::string>& prompts) const {
    const at::NoGradGuard no_grad;
    ClipTextModel encoder = model;
    const at::Device place = encoder->parameters()[0].device();
    const ClipTextOutput first = encoder(tokenizer->encode_batch(prompts).to(place));
    if (!is_sdxl()) return {first.last_hidden_state};
    ClipTextModel encoder_2 = model_2;
    const ClipTextOutput second = encoder_2(tokenizer_2->encode_batch(prompts).to(place));
    const auto last_but_one = [](const ClipTextOutput& output) {
        return output.hidden_states[output.hidden_states.size() - 2];
    };
    return {at::cat({last_but_one(first), last_but_one(second)}, 2), second.text_embeds};
}

void TextEncoders::release_weights() {
    for (ClipTextModel* encoder : {&model, &model_2}) {
        if (encoder->is_empty()) continue;
        for (at::Tensor& parameter : (*encoder)->parameters())
            parameter.set_data(at::empty({0}, parameter.options()));
    }
}

}  // namespace item3d
