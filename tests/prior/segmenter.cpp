// Tests of the segmenter's training data, and of training and measuring a small one.
#include "item3d/networks/vision_language/segmenter.h"

#include "item3d/core/error.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/part_accuracy.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train_clip.h"
#include "item3d/prior/training/train_segmenter.h"
#include "item3d/tensors/safetensors.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr int tiny_image = 48;

ExampleSource mug_source() {
    Random random(5);
    std::vector<TrainingLight> lights{make_training_light(random, "studio", 16)};
    return ExampleSource(make_views("mug", 1, 6, 3, 32, tiny_image), std::move(lights), 8);
}

TEST(PartImages, KnowWhichPixelsAreTheHandle) {
    const PartImages images = draw_part_images(mug_source(), 12, 2);
    ASSERT_EQ(images.parts.sizes(), (at::IntArrayRef{12, tiny_image, tiny_image}));
    bool own = false, handle = false;
    for (std::int64_t i = 0; i < images.count(); ++i) {
        const PartLabels& labels = images.labels[static_cast<std::size_t>(i)];
        ASSERT_EQ(labels.nouns.front(), "mug");
        ASSERT_EQ(labels.parts.size(), labels.seen.size());
        const at::Tensor object = images.mask(i, whole_object(labels));
        EXPECT_TRUE(object.equal(images.parts[i].gt(0).to(at::kFloat)));
        const std::uint32_t named = parts_named(labels, "handle");
        const double share = (images.mask(i, named).sum() / object.sum()).item<double>();
        EXPECT_LT(share, .6);
        handle = handle || share > .03;
        own = own || (labels.own != 0 && !labels.own_phrases.empty());
    }
    EXPECT_TRUE(handle);
    EXPECT_TRUE(own);
    EXPECT_EQ(parts_named(images.labels[0], "wheels"), 0u);
}

TEST(PartImages, AreKeptInAFile) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d_parts_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    const PartImages images = draw_part_images(mug_source(), 3, 1);
    EXPECT_FALSE(has_part_images(folder, "few"));
    save_part_images(folder, "few", images);
    const PartImages again = load_part_images(folder, "few");
    EXPECT_TRUE(again.images.equal(images.images));
    EXPECT_TRUE(again.parts.equal(images.parts));
    EXPECT_EQ(nlohmann::json(again.labels), nlohmann::json(images.labels));
    save_part_images(folder, "more", draw_part_images(mug_source(), 4, 1));
    fs::copy_file(folder / "more.json", folder / "few.json", fs::copy_options::overwrite_existing);
    EXPECT_THROW(load_part_images(folder, "few"), InputError);
    fs::remove_all(folder);
}

/// Returns the labels of a white mug with a red handle. Its spout is on the hidden side.
PartLabels red_handle() {
    PartLabels labels;
    labels.shape_class = "mug";
    labels.nouns = {"mug", "cup"};
    labels.parts = {"", "handle", "spout"};
    labels.seen = {2, 2, 0};
    labels.own = 2;
    labels.phrases = {"white"};
    labels.own_phrases = {"red"};
    return labels;
}

TEST(PartPrompts, NameWhatIsThere) {
    const PartLabels labels = red_handle();
    Random random(3);
    std::map<std::string, std::uint32_t> prompts;
    for (int i = 0; i < 3000; ++i) {
        const PartPrompt prompt = draw_part_prompt(random, labels);
        ASSERT_FALSE(prompt.text.empty());
        const auto [known, added] = prompts.emplace(prompt.text, prompt.parts);
        EXPECT_EQ(known->second, prompt.parts) << prompt.text;
    }
    const std::map<std::string, std::uint32_t> expected{
        {"handle", 2}, {"the red handle", 2}, {"the red part", 2}, {"red", 2},
        {"white", 5},  {"a mug", 7},          {"the object", 7}};
    for (const auto& [text, parts] : expected) {
        ASSERT_TRUE(prompts.count(text)) << text;
        EXPECT_EQ(prompts.at(text), parts) << text;
    }
    EXPECT_FALSE(prompts.count("spout"));  // the image does not show it
    int absent = 0;
    for (const auto& [text, parts] : prompts) {
        if (parts != 0) continue;
        ++absent;
        for (const char* there : {"handle", "mug", "cup", "spout", "object", "red", "white"})
            EXPECT_EQ(text.find(there), std::string::npos) << text;
    }
    EXPECT_GT(absent, 50);
    EXPECT_EQ(named_parts(labels), std::vector<std::string>{"handle"});
    EXPECT_TRUE(has_named(labels, "handles"));
    EXPECT_FALSE(has_named(labels, "wheels"));
}

class TinySegmenter : public ::testing::Test {
  protected:
    ~TinySegmenter() override { fs::remove_all(root_); }

    TrainSettings settings(const char* name, std::int64_t samples) const {
        TrainSettings result;
        result.output = root_ / name;
        result.work = root_ / name / "work";
        result.segmenter_samples = samples;
        fs::create_directories(result.work);
        return result;
    }
    ClipSegConfig config() const {
        ClipSegConfig config = prior_segmenter_config(static_cast<int>(tokenizer_.size()),
                                                      tokenizer_.bos_id(), tokenizer_.eos_id());
        shrink(config.clip);
        config.clip.vision.image_size = tiny_image;
        config.extract_layers = {0, 1};
        config.reduce_dim = 16;
        config.decoder_num_attention_heads = 2;
        config.decoder_intermediate_size = 32;
        return config;
    }
    static void shrink(ClipConfig& clip) {
        clip.vision.hidden_size = clip.text.hidden_size = 16;
        clip.vision.intermediate_size = clip.text.intermediate_size = 32;
        clip.vision.num_attention_heads = clip.text.num_attention_heads = 2;
        clip.vision.num_hidden_layers = 2;
        clip.text.num_hidden_layers = 1;
    }
    NamedTensors checkpoint(const TrainSettings& of) const {
        return SafeTensors::open(of.work / "segmenter_checkpoint.safetensors").tensors();
    }

    PartImages data_ = draw_part_images(mug_source(), 12, 2);
    ClipTokenizer tokenizer_ = train_tokenizer(
        {{"handle", 9}, {"the", 9}, {"mug", 9}, {"a", 9}, {"object", 9}, {"part", 9}}, text_length);
    fs::path root_ = fs::temp_directory_path() / ("item3d_segmenter_" + std::to_string(::getpid()));
};

TEST_F(TinySegmenter, GoesOnAsIfItHadNotStopped) {
    const TrainSettings whole = settings("whole", 120);
    const auto record = train_segmenter(data_, whole, tokenizer_, config());
    EXPECT_GE(record.at("samples"), 120);
    TrainSettings parts = settings("parts", 120);
    parts.stop_after = 48;
    EXPECT_THROW(train_segmenter(data_, parts, tokenizer_, config()), Interrupted);
    parts.stop_after = 0;
    parts.resume = true;
    train_segmenter(data_, parts, tokenizer_, config());
    const NamedTensors expected = checkpoint(whole), found = checkpoint(parts);
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i].first == "record") continue;  // holds seconds
        EXPECT_TRUE(at::equal(expected[i].second, found[i].second)) << expected[i].first;
    }

    // The training writes a segmenter in transformers' layout, which can be measured.
    const Segmenter segmenter = Segmenter::load(whole.output / segmenter_folder);
    const nlohmann::json measured = measure_parts(segmenter, data_);
    EXPECT_EQ(measured.at("pictures"), 12);
    EXPECT_GT(measured.at("words").at("handle").at("asked"), 2);
    EXPECT_EQ(measured.at("worst").at(0).at(0), "handle");
    EXPECT_FALSE(part_summary(measured).contains("words"));
}

TEST_F(TinySegmenter, BeginsWithWhatClipHasLearnt) {
    ClipSegModel model(config());
    ClipConfig clip = prior_clip_config(static_cast<int>(tokenizer_.size()), tokenizer_.bos_id(),
                                        tokenizer_.eos_id());
    shrink(clip);
    clip.vision.num_hidden_layers = 3;
    const ClipModel from(clip);
    ASSERT_TRUE(copy_clip(from, model));
    const at::NoGradGuard no_grad;
    const at::Tensor ids = tokenizer_.encode_batch({"the handle"}, text_length);
    EXPECT_TRUE(model->conditional_embeddings(ids).equal(ClipModel(from)->text_features(ids)));
    const auto ours = model->named_parameters(), theirs = from->named_parameters();
    EXPECT_TRUE(ours["clip.vision_model.encoder.layers.1.mlp.fc1.weight"].equal(
        theirs["vision_model.encoder.layers.1.mlp.fc1.weight"]));
    // The position embedding of the class token is copied, those of the patches are resampled.
    EXPECT_TRUE(ours["clip.vision_model.embeddings.position_embedding.weight"][0].equal(
        theirs["vision_model.embeddings.position_embedding.weight"][0]));

    clip.vision.num_hidden_layers = 1;
    EXPECT_FALSE(copy_clip(ClipModel(clip), model));
}

}  // namespace
}  // namespace item3d
