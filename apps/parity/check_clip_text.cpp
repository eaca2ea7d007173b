#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <charconv>

namespace item3d::parity {
namespace {

/// Returns the number at the end of an output's name ("hidden_states_3").
int number_of(const Case& golden, const std::string& text, int minimum, int maximum) {
    int number = -1;
    const auto end = text.data() + text.size();
    if (std::from_chars(text.data(), end, number).ptr != end || number < minimum ||
        number > maximum)
        throw InputError(golden.folder().string(),
                         "an output's name ends in '" + text + "', which the model has not");
    return number;
}

}  // namespace

void check_clip_text(Case& golden) {
    ClipTextModel model = load_clip_text(golden.folder());
    const at::Tensor ids = golden.input("input_ids");
    const ClipTextOutput output = model(ids);
    const int layers = static_cast<int>(output.hidden_states.size()) - 1;

    golden.compare("last_hidden_state", output.last_hidden_state, within::one_pass);
    golden.compare("pooler_output", output.pooled, within::one_pass);
    if (output.text_embeds.defined())
        golden.compare("text_embeds", output.text_embeds, within::one_pass);
    for (const std::string& suffix : golden.outputs_with_prefix("hidden_states_"))
        golden.compare("hidden_states_" + suffix,
                       output.hidden_states[number_of(golden, suffix, 0, layers)],
                       within::one_pass);
    for (const std::string& suffix : golden.outputs_with_prefix("clip_skip_"))
        golden.compare("clip_skip_" + suffix,
                       model->skip_layers(output, number_of(golden, suffix, 0, layers)),
                       within::one_pass);
    for (const std::string& suffix : golden.outputs_with_prefix("last_hidden_state_len")) {
        const int length = number_of(golden, suffix, 1, static_cast<int>(ids.size(1)));
        golden.compare("last_hidden_state_len" + suffix,
                       model(ids.slice(1, 0, length)).last_hidden_state, within::one_pass);
    }
    if (golden.has("in.attention_mask"))
        golden.compare("last_hidden_state_masked",
                       model(ids, golden.input("attention_mask")).last_hidden_state,
                       within::one_pass);
    model->to(at::kBFloat16);
    golden.orient("last_hidden_state_bf16", model(ids).last_hidden_state, "last_hidden_state");
}

}  // namespace item3d::parity
