#include "apps/parity/parity.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/text_encoders.h"
#include "item3d/networks/diffusion/textual_inversion.h"

namespace item3d::parity {

void check_textual_inversion(Case& golden) {
    const Config meta = golden.meta();
    const Pipeline pipeline = Pipeline::load(golden.folder() / meta.text("pipeline", ""));
    const TextEncoders& text = pipeline.text();
    const std::int64_t before = static_cast<std::int64_t>(pipeline.tokenizer().size());
    if (!meta.has("files") || !meta.json()["files"].is_array())
        meta.fail("files", "a list of [file, token or null]");
    for (const auto& pair : meta.json()["files"]) {
        if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string())
            meta.fail("files", "a list of [file, token or null]");
        add_embedding(golden.folder() / pair[0].get<std::string>(),
                      pair[1].is_string() ? pair[1].get<std::string>() : "",
                      {{text.tokenizer, text.model}});
    }
    const auto after = static_cast<std::int64_t>(pipeline.tokenizer().size());
    golden.compare("vocab_size", at::tensor({before, after}), within::exact);
    const auto table = text.model->named_parameters();
    golden.compare("added_embeddings", table["embeddings.token_embedding.weight"].slice(0, before),
                   within::exact);
    const std::vector<std::string> prompts = meta.texts("prompts", {});
    golden.compare("input_ids", pipeline.tokenizer().encode_batch(prompts), within::exact);
    golden.compare("last_hidden_state", pipeline.encode_text(prompts).states, within::one_pass);
}

}  // namespace item3d::parity
