#include "item3d/networks/vision_language/clip_model.h"

#include "item3d/core/error.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/tensors/weights.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::message_of;
using testing::TemporaryFolder;

TEST(ClipVision, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden("clip_vision_proj");
    ClipVisionWithProjection model = load_clip_vision(fixture("clip_vision_proj"));
    const ClipVisionOutput output = model(golden.in("pixel_values"));
    golden.expect("image_embeds", model->project(output));
    golden.expect("hidden_states_penultimate", output.hidden_states[1]);
}

/// Writes a whole CLIP from recordings of a text and a vision network whose projections have equal
/// widths.
void write_clip(const std::filesystem::path& folder) {
    const auto text = Config::read(fixture("clip_text_proj_eos") / "config.json").json();
    const auto vision = Config::read(fixture("clip_vision_proj") / "config.json").json();
    testing::write_file(folder / "config.json", nlohmann::json{{"architectures", {"CLIPModel"}},
                                                               {"projection_dim", 20},
                                                               {"text_config", text},
                                                               {"vision_config", vision}}
                                                    .dump());
    NamedTensors tensors;
    for (const char* half : {"clip_text_proj_eos", "clip_vision_proj"})
        for (const auto& tensor : SafeTensors::open(fixture(half) / "model.safetensors").tensors())
            tensors.push_back(tensor);
    tensors.emplace_back("logit_scale", at::scalar_tensor(2.0f));
    save_safetensors(folder / "model.safetensors", tensors);
}

TEST(ClipModel, IsItsTwoHalves) {
    const at::NoGradGuard no_grad;
    const TemporaryFolder folder;
    write_clip(folder.path());
    ClipModel model = load_clip_model(folder.path());
    const Golden vision("clip_vision_proj"), text("clip_text_proj_eos");
    vision.expect("image_embeds", model->image_features(vision.in("pixel_values")));
    text.expect("text_embeds", model->text_features(text.in("input_ids")));
    EXPECT_NEAR(model->logit_scale().item<double>(), std::exp(2.0), 1e-5);
}

TEST(ClipModel, PassesGradientsToThePixels) {
    const TemporaryFolder folder;
    write_clip(folder.path());
    ClipModel model = load_clip_model(folder.path());
    model->to(at::kDouble);
    at::manual_seed(3);
    at::Tensor pixels = at::randn({1, 3, 40, 40}, at::kDouble).requires_grad_();
    const at::Tensor direction = at::randn({1, 3, 40, 40}, at::kDouble);
    const at::Tensor weights = at::randn({1, 20}, at::kDouble);
    const auto value = [&](const at::Tensor& x) {
        return (model->image_features(x) * weights).sum();
    };
    value(pixels).backward();
    const at::NoGradGuard no_grad;
    const double step = 1e-5;
    const double slope =
        (value(pixels + step * direction) - value(pixels - step * direction)).item<double>() /
        (2 * step);
    EXPECT_NEAR((pixels.grad() * direction).sum().item<double>(), slope,
                1e-6 * std::max(1.0, std::abs(slope)));
}

TEST(Clip, NamesWhatAFolderLacks) {
    const TemporaryFolder folder;
    write_clip(folder.path());
    const auto message = [&] { return message_of<InputError>([&] { Clip::load(folder.path()); }); };
    EXPECT_NE(message().find("vocab.json"), std::string::npos);
    testing::write_file(folder.path() / "vocab.json",
                        R"({"<|startoftext|>": 0, "<|endoftext|>": 600})");
    testing::write_file(folder.path() / "merges.txt", "#version: 0.2\n");
    EXPECT_NE(message().find("preprocessor_config.json"), std::string::npos);
    testing::write_file(folder.path() / "preprocessor_config.json", R"({"size": 40})");
    EXPECT_NE(message().find("does not scale"), std::string::npos);
    testing::write_file(folder.path() / "preprocessor_config.json",
                        R"({"size": 40, "crop_size": 40})");
    EXPECT_NE(message().find("use the tokenizer of this model"), std::string::npos);
    testing::write_file(folder.path() / "vocab.json",
                        R"({"<|startoftext|>": 0, "<|endoftext|>": 501})");
    EXPECT_EQ(Clip::load(folder.path()).embed_texts({"a"}).sizes(), (at::IntArrayRef{1, 20}));

    std::filesystem::resize_file(folder.path() / "model.safetensors", 100000);
    EXPECT_NE(message().find("model.safetensors"), std::string::npos);
    testing::write_file(folder.path() / "config.json", R"({"architectures": ["CLIPTextModel"]})");
    EXPECT_NE(message().find("CLIPModel"), std::string::npos);
}

}  // namespace
}  // namespace item3d
