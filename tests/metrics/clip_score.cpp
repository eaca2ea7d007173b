#include "item3d/metrics/clip_score.h"

#include "item3d/networks/layers/load_parameters.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"
#include "item3d/report/model_images.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Fixture of a CLIP of random weights that knows the letters a to d.
class RandomClip : public ::testing::Test {
  protected:
    void SetUp() override {
        at::set_num_threads(1);  // so small a network gains nothing from more threads
        folder_ = fs::temp_directory_path() / ("item3d-clip-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        const nlohmann::json layers = {{"hidden_size", 16},
                                       {"intermediate_size", 32},
                                       {"num_hidden_layers", 2},
                                       {"num_attention_heads", 2}};
        nlohmann::json text = layers, vision = layers;
        text.update({{"vocab_size", 8}, {"max_position_embeddings", 16}, {"eos_token_id", 1}});
        vision.update({{"image_size", 32}, {"patch_size", 8}});
        const nlohmann::json config = {
            {"projection_dim", 12}, {"text_config", text}, {"vision_config", vision}};
        write("config.json", config);
        write("vocab.json", {{"<|startoftext|>", 0},
                             {"<|endoftext|>", 1},
                             {"a</w>", 2},
                             {"b</w>", 3},
                             {"c</w>", 4},
                             {"d</w>", 5}});
        std::ofstream(folder_ / "merges.txt") << "#version: 0.2\n";
        write("preprocessor_config.json", {{"size", 32}, {"crop_size", 32}});
        at::manual_seed(11);
        ClipModel model(ClipConfig::from_config(Config(config, "config.json")));
        const at::NoGradGuard no_grad;
        for (auto& parameter : model->parameters())
            parameter.normal_(0, 0.3);
        save_safetensors(folder_ / "model.safetensors", module_tensors(*model));
        clip_ = Clip::load(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    void write(const std::string& name, const nlohmann::json& json) const {
        std::ofstream(folder_ / name) << json.dump();
    }

    fs::path folder_;
    Clip clip_;
};

TEST_F(RandomClip, ScoresAreTheirFormulas) {
    at::manual_seed(12);
    const at::Tensor before = at::rand({2, 3, 48, 48}), after = at::rand({2, 3, 48, 48});
    const ClipScores scores = clip_scores(clip_, before, after, "a b", "c d");
    ASSERT_EQ(scores.views.size(), 2u);
    const at::NoGradGuard no_grad;
    const at::Tensor was = clip_.embed_images(before)[1], is = clip_.embed_images(after)[1];
    const at::Tensor from = clip_.embed_texts({"a b"})[0], to = clip_.embed_texts({"c d"})[0];
    const auto cosine = [](const at::Tensor& a, const at::Tensor& b) {
        return a.dot(b).item<double>() / (a.norm() * b.norm()).item<double>();
    };
    EXPECT_NEAR(scores.views[1].global, cosine(is, to), 1e-5);
    EXPECT_NEAR(scores.views[1].global_before, cosine(was, to), 1e-5);
    EXPECT_NEAR(scores.views[1].directional, cosine(is - was, to - from), 1e-4);
    EXPECT_NEAR(scores.mean.global, (scores.views[0].global + scores.views[1].global) / 2, 1e-9);
}

TEST_F(RandomClip, NothingChangedHasNoDirection) {
    const at::Tensor images = at::rand({1, 3, 40, 60});
    const ClipScores same = clip_scores(clip_, images, images, "a", "b");
    EXPECT_EQ(same.mean.directional, 0);
    EXPECT_EQ(same.mean.global, same.mean.global_before);
    const at::Tensor others = at::rand({1, 3, 40, 60});
    EXPECT_EQ(clip_scores(clip_, images, others, "a", "a").mean.directional, 0);
    // The opposite edit has the opposite direction.
    EXPECT_NEAR(clip_scores(clip_, images, others, "a", "b").mean.directional,
                -clip_scores(clip_, others, images, "a", "b").mean.directional, 1e-6);
}

TEST_F(RandomClip, AscentOnThePixelsRaisesTheScore) {
    at::manual_seed(13);
    const at::Tensor target = clip_.embed_texts({"d"});
    at::Tensor image = at::rand({1, 3, 40, 40}).requires_grad_();
    const at::Tensor before = (clip_.embed_images(image) * target).sum();
    before.backward();
    const at::Tensor step = image.grad() / image.grad().norm();
    const at::NoGradGuard no_grad;
    const at::Tensor after = (clip_.embed_images(image + 0.05 * step) * target).sum();
    EXPECT_GT(after.item<double>(), before.item<double>());
}

TEST(OverWhite, ComposesPremultipliedRadiance) {
    at::Tensor linear = at::zeros({1, 1, 3, 4});
    linear[0][0][1] = at::tensor({0.25f, 0.0f, 0.0f, 0.5f});  // half covered by (0.5, 0, 0)
    linear[0][0][2] = at::tensor({2.0f, 1.0f, 0.0f, 1.0f});   // too bright for an image
    const at::Tensor images = over_white(linear);
    ASSERT_EQ(images.sizes(), (at::IntArrayRef{1, 3, 1, 3}));
    const at::Tensor expected = linear_to_srgb(
        at::tensor({1.0f, 1.0f, 1.0f, 0.75f, 0.5f, 0.5f, 1.0f, 1.0f, 0.0f}, at::kFloat)
            .view({3, 3}));
    EXPECT_LT((images[0].select(1, 0).t() - expected).abs().max().item<float>(), 1e-6f);
}

}  // namespace
}  // namespace item3d
