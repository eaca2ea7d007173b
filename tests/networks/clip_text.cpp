#include "item3d/networks/vision_language/clip_text.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/load_parameters.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::TemporaryFolder;

class ClipText : public ::testing::TestWithParam<const char*> {};

TEST_P(ClipText, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden(GetParam());
    ClipTextModel model = load_clip_text(fixture(GetParam()));
    const at::Tensor ids = golden.in("input_ids");
    const ClipTextOutput output = model(ids);
    golden.expect("last_hidden_state", output.last_hidden_state);
    golden.expect("hidden_states_0", output.hidden_states[0]);
    golden.expect("clip_skip_1", model->skip_layers(output, 1));
    golden.expect("last_hidden_state_len20", model(ids.slice(1, 0, 20)).last_hidden_state);
    golden.expect("last_hidden_state_masked",
                  model(ids, golden.in("attention_mask")).last_hidden_state);
    if (output.text_embeds.defined())
        golden.expect("text_embeds", output.text_embeds);
    else
        golden.expect("pooler_output", output.pooled);
}

// The first network pools at the largest id, as old configs require. The second pools at the real
// end token and projects.
INSTANTIATE_TEST_SUITE_P(Cases, ClipText,
                         ::testing::Values("clip_text_sd15", "clip_text_proj_eos"));

TEST(ClipTextModel, LoadsNamesWithAndWithoutThePrefix) {
    const at::NoGradGuard no_grad;
    const Golden golden("clip_text_sd15");
    ClipTextModel model = load_clip_text(fixture("clip_text_sd15"));
    const TemporaryFolder folder;
    testing::write_file(folder.path() / "config.json", model->config().to_json().dump());
    for (const bool published : {false, true}) {
        const auto tensors = published ? published_tensors(model) : module_tensors(*model);
        EXPECT_EQ(tensors[0].first.starts_with("text_model."), published);
        save_safetensors(folder.path() / "model.safetensors", tensors);
        golden.expect(
            "last_hidden_state",
            load_clip_text(folder.path())->forward(golden.in("input_ids")).last_hidden_state);
    }
}

TEST(ClipTextModel, ATokenSeesOnlyWhatCameBefore) {
    at::manual_seed(6);
    ClipTextModel model(ClipTextConfig::from_json({{"vocab_size", 20},
                                                   {"hidden_size", 8},
                                                   {"intermediate_size", 16},
                                                   {"num_hidden_layers", 2},
                                                   {"num_attention_heads", 2},
                                                   {"max_position_embeddings", 6}}));
    const at::Tensor first =
        model(at::tensor({1, 2, 3, 4}, at::kLong).view({1, 4})).last_hidden_state;
    const at::Tensor second =
        model(at::tensor({1, 2, 3, 5}, at::kLong).view({1, 4})).last_hidden_state;
    const auto difference = (first - second).abs().amax({0, 2});
    EXPECT_LT(difference.slice(0, 0, 3).max().item<float>(), 1e-6f);
    EXPECT_GT(difference[3].item<float>(), 1e-4f);
}

TEST(ClipTextModel, RejectsOtherModels) {
    EXPECT_THROW(ClipTextConfig::from_json({{"architectures", {"BertModel"}}}), InputError);
    EXPECT_THROW(ClipTextConfig::from_json({{"hidden_act", "relu"}}), InputError);
    EXPECT_THROW(ClipTextConfig::from_json({{"hidden_size", 10}, {"num_attention_heads", 3}}),
                 InputError);
}

}  // namespace
}  // namespace item3d
