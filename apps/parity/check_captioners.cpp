#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/blip2.h"
#include "item3d/text/bert_tokenizer.h"
#include "item3d/text/gpt2_tokenizer.h"

namespace item3d::parity {
namespace {

/// Compares tokens.json: texts with their ids and decoded texts.
void compare_tokens(Case& golden, const CaptionTokenizer& tokenizer) {
    const std::filesystem::path path = golden.folder() / "tokens.json";
    if (!std::filesystem::exists(path)) return;
    const nlohmann::json rows = nlohmann::json::parse(read_text(path), nullptr, false);
    if (!rows.is_array()) throw InputError(path.string(), "expected a list");
    std::int64_t count = 0, different_ids = 0, different_texts = 0;
    for (const auto& row : rows) {
        const auto ids = row.at("ids").get<std::vector<int>>();
        ++count;
        different_ids += tokenizer.encode(row.at("text").get<std::string>()) != ids;
        different_texts += tokenizer.decode(ids) != row.at("decoded").get<std::string>();
    }
    golden.compare_texts("tokens.json ids", count, different_ids);
    golden.compare_texts("tokens.json decoded", count, different_texts);
}

at::Tensor row(const std::vector<int>& ids) {
    return at::tensor(std::vector<std::int64_t>(ids.begin(), ids.end())).unsqueeze(0);
}

}  // namespace

void check_blip(Case& golden) {
    const Config meta = golden.meta();
    BlipModel model = load_blip(golden.folder());
    const at::Tensor pixels = golden.input("pixel_values"), ids = golden.input("input_ids");
    const at::Tensor embeds = model->image_embeds(pixels);
    golden.compare("image_embeds", embeds, within::one_pass);
    const auto image = model->read_image(embeds);
    const auto logits = [&](const at::Tensor& visible) {
        return model->logits(model->decode(ids, visible, image));
    };
    golden.compare("logits", logits(golden.input("attention_mask")), within::one_pass);
    golden.compare("logits_nomask", logits(at::ones_like(ids)), within::one_pass);

    const BertTokenizer tokenizer = BertTokenizer::load(golden.folder());
    compare_tokens(golden, tokenizer);
    at::Tensor prompt = row(tokenizer.encode(meta.text("prompt", "")));
    golden.compare("prompt_ids", prompt, within::exact);
    const at::Tensor begin = at::full({1, 1}, model->config().bos_token_id, at::kLong);
    prompt = at::cat({begin, prompt.slice(1, 1, -1)}, 1);
    for (const std::string kind : {"greedy", "beam"}) {
        DecodingOptions options;
        options.max_new_tokens = meta.size("max_new_tokens", 1);
        options.beams = kind == "beam" ? meta.size("num_beams", 1) : 1;
        const Decoded plain = write_captions(model, pixels, begin, options);
        golden.compare(kind + "_ids", plain.tokens, within::exact);
        if (plain.scores.defined())
            golden.compare("beam_sequences_scores", plain.scores, within::one_pass);
        golden.compare(kind + "_ids_prompt", write_captions(model, pixels, prompt, options).tokens,
                       within::exact);
    }
    compare_image_processors(golden);
}

void check_blip2(Case& golden) {
    const Config meta = golden.meta();
    Blip2Model model = load_blip2(golden.folder());
    const Blip2Config& config = model->config();
    const at::Tensor pixels = golden.input("pixel_values"), ids = golden.input("input_ids");
    const at::Tensor embeds = model->image_embeds(pixels);
    golden.compare("vision_last_hidden_state", embeds, within::one_pass);
    const at::Tensor queried = model->query_image(embeds);
    golden.compare("qformer_last_hidden_state", queried, within::one_pass);
    const at::Tensor image = model->project(queried);
    golden.compare("language_projection", image, within::one_pass);
    OptModel language_model = model->language_model();
    golden.compare("logits",
                   language_model->logits(language_model->forward(model->embed(ids, image),
                                                                  golden.input("attention_mask"))),
                   within::one_pass);

    const Gpt2Tokenizer tokenizer = Gpt2Tokenizer::load(golden.folder());
    compare_tokens(golden, tokenizer);
    // There are three recorded prompts: two with the text, and a shorter one with padding on the
    // left.
    const auto places = std::vector<int>(config.num_query_tokens, config.image_token_index);
    const auto with_image = [&](const std::string& text) {
        std::vector<int> result = places;
        const auto tokens = tokenizer.encode(text);
        result.insert(result.end(), tokens.begin(), tokens.end());
        return row(result);
    };
    const at::Tensor longer = with_image(meta.text("prompt", ""));
    const at::Tensor shorter = with_image("a photo of");
    const auto padding = longer.size(1) - shorter.size(1);
    const at::Tensor prompts = at::cat(
        {longer, at::constant_pad_nd(shorter, {padding, 0}, config.text.pad_token_id), longer});
    at::Tensor visible = at::ones_like(prompts);
    visible[1].narrow(0, 0, padding).zero_();
    golden.compare("prompt_ids", prompts, within::exact);
    golden.compare("prompt_mask", visible, within::exact);
    const at::Tensor begin = with_image("");
    for (const std::string kind : {"greedy", "beam"}) {
        DecodingOptions options;
        options.max_new_tokens = meta.size("max_new_tokens", 1);
        options.beams = kind == "beam" ? meta.size("num_beams", 1) : 1;
        options.end_token = config.text.eos_token_id;
        golden.compare(kind + "_ids", write_captions(model, pixels, begin, {}, options).tokens,
                       within::exact);
        golden.compare(kind + "_ids_prompt",
                       write_captions(model, pixels, prompts, visible, options).tokens,
                       within::exact);
    }
    compare_image_processors(golden);
}

}  // namespace item3d::parity
