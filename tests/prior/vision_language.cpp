// Tests of the facts about training images, and of training and measuring a small CLIP and
// captioner.
#include "item3d/prior/training/vision_language.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/materials/colors.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/vision_language_accuracy.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train_captioner.h"
#include "item3d/prior/training/train_clip.h"
#include "item3d/tensors/safetensors.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace item3d {
namespace {

namespace fs = std::filesystem;

ImageLabels labels(const std::vector<std::string>& phrases, const std::string& noun) {
    return {phrases, {noun}, {}};
}

TEST(ImageLabels, SayWhatIsTrueOfAImage) {
    Random random(4);
    TrainingLight night_light{"night", {" at night", " at night", " in the dark"}, {}, {}};
    const ShapeClass mug{"mug", {"mug", "cup"}}, teapot{"teapot", {"teapot"}, true};
    const ProceduralMaterial red = make_material(random, {"plain", "red", ""});
    const ImageLabels night = labels_of(mug, red, night_light);
    EXPECT_EQ(plain_claim(night).text(), "a red mug");
    EXPECT_EQ(plain_claim(labels_of(teapot, red, night_light)).text(), "a red object");
    EXPECT_EQ(night.lights, (std::vector<std::string>{" at night", " in the dark"}));

    EXPECT_TRUE(holds({"red {o}", "cup", " in the dark"}, night));
    EXPECT_TRUE(holds({"", "mug", ""}, night));
    EXPECT_TRUE(holds({"red {o}", "object", ""}, night));
    EXPECT_FALSE(holds({"blue {o}", "mug", ""}, night));
    EXPECT_FALSE(holds({"red {o}", "vase", ""}, night));
    EXPECT_FALSE(holds({"red {o}", "mug", " at sunset"}, night));
    for (int i = 0; i < 50; ++i)
        EXPECT_TRUE(holds(draw_claim(random, night), night));

    // The handle has its own material. Claims about the other part alone are still true.
    const PartMaterial handle{"handle", make_material(random, {"metal", "gold", ""})};
    const ImageLabels two = labels_of(mug, red, night_light, &handle);
    EXPECT_EQ(plain_claim(two).text(), "a red mug with a golden handle");
    EXPECT_EQ(whole_claim(two).text(), "a red mug");
    EXPECT_EQ(whole_claim(night).text(), "a red mug");
    EXPECT_TRUE(holds({"red {o}", "mug", ""}, two));
    EXPECT_TRUE(judge_caption("a red cup with a golden handle", two).material);
    EXPECT_FALSE(judge_caption("a golden mug", two).material);

    // Colours may be named in any order.
    const ProceduralMaterial stripes = make_material(random, {"striped", "white", "blue"});
    EXPECT_EQ(labels_of(mug, stripes, night_light).phrases.front(), "blue and white striped {o}");
    EXPECT_EQ((ClaimedLabels{"orange {o}", "lamp", " at noon"}.text("a photo of ")),
              "a photo of an orange lamp at noon");
    const ImageLabels copy = nlohmann::json(night).get<ImageLabels>();
    EXPECT_EQ(copy.phrases, night.phrases);
    EXPECT_EQ(copy.lights, night.lights);
}

TEST(ImageLabels, CaptionsAreJudgedWordForWord) {
    const ImageLabels flames = labels({"{o} with a flame pattern"}, "cow");
    const auto verdict = [&](const std::string& caption) {
        const CaptionVerdict v = judge_caption(caption, flames);
        return std::pair(v.object, v.material);
    };
    EXPECT_EQ(verdict("a cow with a flame pattern"), std::pair(true, true));
    EXPECT_EQ(verdict("a photo of a duck with a flame pattern"), std::pair(false, true));
    EXPECT_EQ(verdict("a red cow"), std::pair(true, false));
    EXPECT_EQ(verdict(""), std::pair(false, false));
    // The caption contains the word "red", but does not claim that the mug is red.
    EXPECT_FALSE(judge_caption("a red and white striped mug", labels({"red {o}"}, "mug")).material);
    // A part may have the name of another object.
    const auto hatted = judge_caption("a white snowman with a red hat",
                                      labels({"white {o} with a red hat"}, "snowman"));
    EXPECT_TRUE(hatted.object && hatted.material);
}

TEST(ImageLabels, AMaterialHasItsNameWhateverItsColors) {
    const auto names = [](const std::string& caption, const ImageLabels& labels) {
        const CaptionVerdict verdict = judge_caption(caption, labels);
        EXPECT_FALSE(verdict.material) << caption;
        return verdict.material_name;
    };
    const ImageLabels velvet = labels({"maroon velvet {o}", "velvet {o}"}, "cup");
    EXPECT_TRUE(names("a pink velvet cup", velvet));
    EXPECT_FALSE(names("a maroon cup", velvet));
    EXPECT_FALSE(names("a maroon silk cup", velvet));
    EXPECT_FALSE(names("a cup", velvet));
    const ImageLabels striped = labels({"red and white striped {o}"}, "cup");
    EXPECT_TRUE(names("a red and pink striped cup", striped));
    EXPECT_FALSE(names("a red and white checkered cup", striped));
    EXPECT_TRUE(names("a bronze cup", labels({"hammered bronze {o}"}, "cup")));
    // A material that is only a colour has the colour's name.
    EXPECT_FALSE(names("a salmon cup", labels({"red {o}", "glossy red {o}"}, "cup")));
    EXPECT_TRUE(judge_caption("a red cup", labels({"red {o}"}, "cup")).material_name);
    // The material of a part is not that of the whole object.
    const ImageLabels two =
        labels({"wooden {o} with a red handle", "{o} with a red handle", "wooden {o}"}, "cup");
    EXPECT_FALSE(names("a red cup", two));
    EXPECT_TRUE(judge_caption("a wooden cup", two).material_name);
}

TEST(SharedVision, ClipSeesWhatTheCaptionerSees) {
    const std::int64_t side = read_size;
    BlipConfig blip = prior_captioner_config(20);
    ClipConfig clip = prior_clip_config(40, 38, 39);
    at::manual_seed(2);
    const BlipModel captioner(blip);
    ClipModel model(clip), other(clip);
    {
        const at::NoGradGuard no_grad;
        for (auto& item : captioner->named_parameters())
            if (item.key().find("embeddings") != std::string::npos)
                // The class token gets about the size of the patches' tokens, as the copy assumes.
                item.value().normal_(0, item.key().ends_with("class_embedding") ? 2 : .1);
    }
    const at::Tensor images = at::randn({4, 3, side, side});
    ASSERT_TRUE(copy_vision(captioner, model, images));
    const at::NoGradGuard no_grad;
    BlipModel reader = captioner;
    const at::Tensor theirs = reader->image_embeds(images).select(1, 0);
    const auto likeness = [&](ClipModel each) {
        return at::cosine_similarity(theirs, each->vision()->forward(images).pooled, 1)
            .mean()
            .item<double>();
    };
    EXPECT_GT(likeness(model), .9);
    EXPECT_LT(likeness(other), .5);

    clip.vision.num_hidden_layers = 2;
    EXPECT_FALSE(copy_vision(captioner, ClipModel(clip), images));
}

/// Fixture: flat images of six colours, whose captions name the colours.
class VisionLanguage : public ::testing::Test {
  protected:
    VisionLanguage() {
        constexpr std::int64_t count = 120;
        const auto& colors = plain_colors();
        data_.images = at::zeros({count, prior_image_size, prior_image_size, 3}, at::kByte);
        for (std::int64_t i = 0; i < count; ++i) {
            const PlainColor& color = colors[static_cast<std::size_t>(i % 6)];
            for (int c = 0; c < 3; ++c)
                data_.images[i].select(2, c).fill_(255 * color.linear[c]);
            data_.labels.push_back(labels({color.name + " {o}"}, "mug"));
            if (i < 6) words_.push_back({color.name, 1});
        }
        words_.insert(words_.end(), {{"a", 3}, {"an", 3}, {"mug", 3}, {"object", 1}, {"of", 1}});
    }
    ~VisionLanguage() override { fs::remove_all(root_); }

    TrainSettings settings(const char* name, std::int64_t samples) const {
        TrainSettings result;
        result.output = root_ / name;
        result.work = root_ / name / "work";
        result.clip_samples = result.captioner_samples = samples;
        result.learning_rate = 4e-3f;
        fs::create_directories(result.work);
        return result;
    }
    BlipConfig small_captioner() const {
        BlipConfig config = prior_captioner_config(static_cast<int>(words_.size()));
        config.vision.hidden_size = config.hidden_size = 16;
        config.vision.intermediate_size = config.intermediate_size = 32;
        config.vision.num_hidden_layers = config.num_hidden_layers = 1;
        config.vision.num_attention_heads = config.num_attention_heads = 2;
        return config;
    }
    static ClipConfig small_clip(const ClipTokenizer& tokenizer) {
        ClipConfig config = prior_clip_config(static_cast<int>(tokenizer.size()),
                                              tokenizer.bos_id(), tokenizer.eos_id());
        config.vision.hidden_size = config.text.hidden_size = 16;
        config.vision.intermediate_size = config.text.intermediate_size = 32;
        config.vision.num_hidden_layers = config.text.num_hidden_layers = 1;
        config.vision.num_attention_heads = config.text.num_attention_heads = 2;
        return config;
    }
    static NamedTensors checkpoint(const TrainSettings& settings, const char* name) {
        return SafeTensors::open(settings.work / name).tensors();
    }

    LabeledImages data_;
    std::vector<WordCount> words_;
    fs::path root_ = fs::temp_directory_path() / ("item3d_readers_" + std::to_string(::getpid()));
};

TEST_F(VisionLanguage, ClipLearnsToTellColorsApart) {
    const TrainSettings whole = settings("whole", 6400);
    const ClipTokenizer tokenizer = train_tokenizer(words_, text_length);
    const auto record = train_clip(data_, whole, tokenizer, small_clip(tokenizer));
    EXPECT_GE(record.at("samples"), 6400);
    const Clip clip = Clip::load(whole.output / clip_folder);
    const RetrievalAccuracy accuracy = measure_retrieval(clip, data_, 6);
    EXPECT_EQ(accuracy.rounds, 20);
    EXPECT_GT(accuracy.image_to_caption, .6);  // 1 / 6 by chance
    EXPECT_THROW(measure_retrieval(clip, data_, 7), InputError);
}

TEST_F(VisionLanguage, CaptionerLearnsColorsAndResumes) {
    const TrainSettings whole = settings("whole", 9600);
    train_captioner(data_, whole, words_, small_captioner());
    const auto captioner = load_captioner(whole.output / captioner_folder);
    const CaptionAccuracy accuracy = measure_captions(*captioner, data_, 2);
    EXPECT_EQ(accuracy.count, 120);
    EXPECT_GT(accuracy.object, .9);
    EXPECT_GT(accuracy.material, .6);

    TrainSettings parts = settings("parts", 9600);
    parts.stop_after = 4800;
    EXPECT_THROW(train_captioner(data_, parts, words_, small_captioner()), Interrupted);
    parts.resume = true;
    parts.stop_after = 0;
    train_captioner(data_, parts, words_, small_captioner());
    const char* file = "captioner_checkpoint.safetensors";
    const NamedTensors expected = checkpoint(whole, file), found = checkpoint(parts, file);
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i].first == "record") continue;  // holds seconds
        EXPECT_TRUE(at::equal(expected[i].second, found[i].second)) << expected[i].first;
    }
}

TEST_F(VisionLanguage, BeginsWithTheReadersOfAnotherPrior) {
    const TrainSettings first = settings("first", 640);
    train_captioner(data_, first, words_, small_captioner());
    const ClipTokenizer tokenizer = train_tokenizer(words_, text_length);
    train_clip(data_, first, tokenizer, small_clip(tokenizer));
    TrainSettings second = settings("second", 128);
    second.init_from = first.output;
    second.learning_rate = 1e-9f;
    second.seed = 2;
    // The order of words may differ, because the vocabulary of the weights is kept.
    std::vector<WordCount> turned(words_.rbegin(), words_.rend());
    train_captioner(data_, second, turned, small_captioner());
    train_clip(data_, second, ClipTokenizer::load(first.output / clip_folder),
               small_clip(tokenizer));
    const fs::path vocabulary = fs::path(captioner_folder) / "vocab.txt";
    EXPECT_EQ(read_text(first.output / vocabulary), read_text(second.output / vocabulary));
    for (const char* part : {captioner_folder, clip_folder}) {
        const fs::path file = fs::path(part) / "model.safetensors";
        const SafeTensors found = SafeTensors::open(second.output / file);
        for (const auto& [name, tensor] : SafeTensors::open(first.output / file).tensors())
            EXPECT_TRUE(
                at::allclose(tensor.to(at::kFloat), found.tensor(name).to(at::kFloat), 2e-3, 1e-5))
                << part << " " << name;
    }
    // A mismatch is reported before any training image is drawn.
    const auto refusal = [](const TrainSettings& settings, bool clip, bool captioner) {
        try {
            check_init_from_readers(settings, clip, captioner);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const bool clip : {false, true}) {
        const char* part = clip ? clip_folder : captioner_folder;
        EXPECT_EQ(refusal(second, clip, !clip)
                      .find((first.output / part / "config.json").string() + ": "),
                  0u);
        EXPECT_TRUE(init_from_part(second, part) == first.output / part);
    }
    fs::remove(first.output / vocabulary);
    save_blip(first.output / captioner_folder, BlipModel(prior_captioner_config(8)));
    EXPECT_NE(refusal(second, false, true).find("vocab.txt"), std::string::npos);
    fs::remove_all(first.output / captioner_folder);
    EXPECT_TRUE(init_from_part(second, captioner_folder).empty());
    EXPECT_EQ(refusal(second, false, true), "");
    second.output = first.output;
    EXPECT_NE(refusal(second, true, true).find("-o"), std::string::npos);
}

TEST(HeldOutModels, AreOneThingFromSeveralSides) {
    const LabeledModels models = draw_held_out_models(3, 4, 2, 2);
    ASSERT_EQ(models.views.size(), 4u);
    ASSERT_EQ(models.labels.size(), 4u);
    for (std::size_t i = 0; i < models.views.size(); ++i) {
        ASSERT_EQ(models.views[i].size(), 2u);
        EXPECT_FALSE(models.views[i][0].equal(models.views[i][1]));
        EXPECT_FALSE(models.labels[i].phrases.empty());
    }
    const LabeledModels again = draw_held_out_models(3, 4, 2, 1);
    EXPECT_TRUE(again.views[3][1].equal(models.views[3][1]));
}

TEST_F(VisionLanguage, ImagesAndLabelsAreKeptTogether) {
    fs::create_directories(root_);
    save_labeled(root_, "pictures", data_);
    EXPECT_TRUE(has_labeled(root_, "pictures"));
    const LabeledImages loaded = load_labeled(root_, "pictures");
    EXPECT_TRUE(at::equal(loaded.images, data_.images));
    EXPECT_EQ(loaded.labels.back().phrases, data_.labels.back().phrases);
    write_atomically(root_ / "pictures.json", "[]\n");
    EXPECT_THROW(load_labeled(root_, "pictures"), InputError);
    write_atomically(root_ / "pictures.json", "[[1]]\n");
    EXPECT_THROW(load_labeled(root_, "pictures"), InputError);
}

/// Tests the networks that ship with item3d on a few held-out shapes.
TEST(ShippedNetworks, TellHeldOutShapesApart) {
    const fs::path prior = fs::path(ITEM3D_TEST_DATA) / "../../assets/prior";
    Random random(7);
    const TrainingLight light = make_training_light(random, "studio");
    const std::vector<MaterialWish> materials{{"plain", "red", ""},  {"plain", "blue", ""},
                                              {"metal", "gold", ""}, {"grass", "", ""},
                                              {"brick", "", ""},     {"wood", "", ""}};
    LabeledImages pictures;
    std::vector<at::Tensor> images;
    for (const char* shape : {"mug", "vase", "chair", "snowman"}) {
        const std::vector<ShapeView> views = make_views(shape, shape_variants - 1, 6, 3, 64);
        for (std::size_t i = 0; i < views.size(); ++i) {
            ExampleWish wish;
            wish.material = materials[i];
            wish.light = &light;
            wish.plain_background = true;
            wish.part = "none";
            Example example = draw_example(random, views[i], {}, wish);
            images.push_back((example.image * 255).round().to(at::kByte));
            pictures.labels.push_back(std::move(example.labels));
        }
    }
    pictures.images = at::stack(images);
    const RetrievalAccuracy found =
        measure_retrieval(Clip::load(prior / clip_folder), pictures, 24);
    EXPECT_GT(found.image_to_caption, .6);  // 1 / 24 by chance
    const CaptionAccuracy named =
        measure_captions(*load_captioner(prior / captioner_folder), pictures, 2);
    EXPECT_GT(named.object_or_material, .8);
    EXPECT_GT(named.object, .5);
    EXPECT_GT(named.material, .5);
}

}  // namespace
}  // namespace item3d
