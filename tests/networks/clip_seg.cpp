#include "item3d/networks/vision_language/clip_seg.h"

#include "item3d/core/error.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/text/clip_tokenizer.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

const std::vector<std::string> asked_prompts{"a handle", "the red seat of a chair", "WHEELS!"};

/// Parameter: the variant of the network, with one transposed convolution ("plain") or three
/// convolutions ("refined").
class ClipSeg : public ::testing::TestWithParam<std::string> {
  protected:
    std::string name(const std::string& tensor) const { return GetParam() + "." + tensor; }

    const at::NoGradGuard no_grad_;
    const Golden golden_{"clip_seg"};
    ClipSegModel model_ = load_clip_seg(fixture("clip_seg") / GetParam());
    const at::Tensor embeddings_ = model_->conditional_embeddings(golden_.out("input_ids"));
};

INSTANTIATE_TEST_SUITE_P(Kinds, ClipSeg, ::testing::Values("plain", "refined"));

TEST_P(ClipSeg, ReproducesTheReference) {
    golden_.expect(name("conditional_embeddings"), embeddings_);
    const at::Tensor pixels = golden_.in("pixel_values");
    golden_.expect(name("activation_2"), model_->activations(pixels)[2]);
    // Each image has its own prompt, as in the reference.
    const at::Tensor logits = model_->forward(pixels, embeddings_.unsqueeze(1)).squeeze(1);
    golden_.expect(name("logits_random"), logits);
    EXPECT_EQ(logits.size(2), model_->config().mask_size(32));
}

TEST_P(ClipSeg, InterpolatesItsPositionsForLargerImages) {
    const at::Tensor big = golden_.in("pixel_values_big");
    golden_.expect(name("logits_big"), model_->forward(big, embeddings_.unsqueeze(1)).squeeze(1));
}

TEST_P(ClipSeg, AsksAllPromptsOfAllImages) {
    const ImageProcessor processor = ImageProcessor::load(fixture("clip_seg") / GetParam());
    std::vector<at::Tensor> pixels;
    for (const std::string image : {"0", "1"}) {
        pixels.push_back(processor.process(golden_.in("picture." + image)));
        golden_.expect("pixel_values." + image, pixels.back(), 1e-5);
    }
    const at::Tensor logits = model_->forward(at::cat(pixels), embeddings_);
    golden_.expect(name("logits_0"), logits[0]);
    golden_.expect(name("logits_1"), logits[1]);
}

TEST_P(ClipSeg, IsReadAsItWasWritten) {
    const TemporaryFolder folder;
    save_clip_seg(folder.path(), model_, at::kFloat);
    ClipSegModel again = load_clip_seg(folder.path());
    EXPECT_EQ(again->config().to_json(), model_->config().to_json());
    const at::Tensor pixels = golden_.in("pixel_values");
    EXPECT_EQ(largest_difference(again->forward(pixels, embeddings_),
                                 model_->forward(pixels, embeddings_)),
              0);
}

TEST(Segmenter, FindsWhatPromptsName) {
    const at::NoGradGuard no_grad;
    const Golden golden("clip_seg");
    const Segmenter segmenter = Segmenter::load(fixture("clip_seg") / "plain");
    EXPECT_TRUE(
        segmenter.tokenizer().encode_batch(asked_prompts, 77).equal(golden.out("input_ids")));
    const at::Tensor image =
        golden.in("picture.0").permute({2, 0, 1}).unsqueeze(0).to(at::kFloat) / 255;
    const at::Tensor logits = segmenter.segment(image, asked_prompts);
    // The segmenter resizes the image without rounding to bytes, so results differ slightly.
    golden.expect("plain.logits_0", logits[0], .02);
    const at::Tensor masks = segmenter.masks(image, asked_prompts);
    EXPECT_EQ(masks.sizes(), (at::IntArrayRef{1, 3, image.size(2), image.size(3)}));
    EXPECT_GE(masks.min().item<float>(), 0.0f);
    EXPECT_LE(masks.max().item<float>(), 1.0f);

    const Segmenter packed =
        Segmenter::load_to_run(fixture("clip_seg") / "plain", at::kCPU, at::kFloat);
    EXPECT_LT(largest_difference(packed.segment(image, asked_prompts), logits), 1e-4);
}

TEST(Segmenter, PassesGradientsToTheImage) {
    const Segmenter segmenter = Segmenter::load(fixture("clip_seg") / "plain");
    at::manual_seed(2);
    at::Tensor image = at::rand({1, 3, 20, 24}).requires_grad_();
    segmenter.segment(image, {"a handle"}).sum().backward();
    EXPECT_GT(image.grad().abs().max().item<float>(), 0.0f);
}

TEST(Segmenter, SaysWhatIsWrongWithAFolder) {
    const auto message = [](const fs::path& folder) {
        return message_of<InputError>([&] { Segmenter::load(folder); });
    };
    EXPECT_NE(message(fixture("clip_seg") / "refined").find("vocab.json"), std::string::npos);
    const std::string other = message(fixture("clip_vision_proj"));
    EXPECT_NE(other.find("config.json"), std::string::npos) << other;
    EXPECT_NE(other.find("CLIPSegForImageSegmentation"), std::string::npos) << other;

    const TemporaryFolder folder;
    fs::copy(fixture("clip_seg") / "plain", folder.path(), fs::copy_options::recursive);
    const auto with = [&](const char* key, const nlohmann::json& value) {
        nlohmann::json config = Config::read(fixture("clip_seg") / "plain" / "config.json").json();
        config[key] = value;
        fs::remove(folder.path() / "config.json");
        testing::write_file(folder.path() / "config.json", config.dump());
        return message(folder.path());
    };
    EXPECT_NE(with("extract_layers", {1, 9}).find("extract_layers"), std::string::npos);
    EXPECT_NE(with("conditional_layer", 3).find("conditional_layer"), std::string::npos);
    EXPECT_NE(with("reduce_dim", 24).find("model.safetensors"), std::string::npos);
}

}  // namespace
}  // namespace item3d
