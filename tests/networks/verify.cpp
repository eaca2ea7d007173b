#include "item3d/networks/verify.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/tensors/safetensors.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::message_of;
using testing::TemporaryFolder;
using testing::write_file;

/// Fixture: a copy of the small pipeline that a test may damage.
class Verify : public ::testing::Test {
  protected:
    void SetUp() override {
        fs::copy(fixture("pipeline_sd"), prior(), fs::copy_options::recursive);
    }
    fs::path prior() const { return folder_.path() / "prior"; }
    /// Replaces the first occurrence of `from` in a file.
    void change(const fs::path& file, const std::string& from, const std::string& to) const {
        std::string text = read_text(prior() / file);
        const auto at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        write_file(prior() / file, text.replace(at, from.size(), to));
    }
    /// Checks that there is exactly one problem and that it contains `part`.
    void expect_problem(const std::string& part) const {
        const PriorReport report = verify_prior(prior());
        ASSERT_EQ(report.problems.size(), 1u) << part;
        EXPECT_NE(report.problems[0].find(part), std::string::npos) << report.problems[0];
        EXPECT_EQ(report.problems[0].find('\n'), std::string::npos);
        EXPECT_TRUE(report.memory.empty());
    }

    const fs::path unet = "unet/diffusion_pytorch_model.safetensors";

  private:
    TemporaryFolder folder_;
};

TEST_F(Verify, NetworksBesideThePipelineAreReadToo) {
    fs::copy(fixture("blip"), prior() / "captioner", fs::copy_options::recursive);
    const PriorReport report = verify_prior(prior());
    EXPECT_TRUE(report.usable()) << report.problems.front();
    ASSERT_EQ(report.parts.size(), 6u);
    EXPECT_EQ(report.parts.back().name, "captioner");
    EXPECT_EQ(report.parts.back().class_name, "BlipForConditionalGeneration");
    EXPECT_GT(report.parts.back().parameters, 1000);

    fs::copy(fixture("clip_seg") / "plain", prior() / "segmenter", fs::copy_options::recursive);
    EXPECT_EQ(verify_prior(prior()).parts.back().class_name, "CLIPSegForImageSegmentation");
    fs::remove(prior() / "segmenter" / "vocab.json");
    expect_problem("segmenter/vocab.json");
    fs::remove_all(prior() / "segmenter");

    fs::remove(prior() / "captioner" / "vocab.txt");
    expect_problem("captioner/vocab.txt");
}

TEST_F(Verify, CountsWhatLoadingFinds) {
    const PriorReport report = verify_prior(prior());
    EXPECT_TRUE(report.usable());
    EXPECT_EQ(report.pipeline_class, "StableDiffusionPipeline");
    const Pipeline pipeline = Pipeline::load(prior());
    std::int64_t parameters = 0;
    for (const auto& tensor : pipeline.networks().unet->parameters())
        parameters += tensor.numel();
    ASSERT_EQ(report.parts.size(), 5u);
    for (const PartReport& part : report.parts)
        if (part.name == "unet") {
            EXPECT_EQ(part.parameters, parameters);
            EXPECT_EQ(part.file_bytes, static_cast<std::uint64_t>(4 * parameters));
        }
    for (const auto& tensor : pipeline.networks().vae->parameters())
        parameters += tensor.numel();
    std::uint64_t text = 0;
    for (const auto& tensor : pipeline.text().model->parameters())
        text += static_cast<std::uint64_t>(tensor.numel());
    EXPECT_EQ(report.parameters(), parameters + static_cast<std::int64_t>(text));
    ASSERT_EQ(report.memory.size(), 3u);
    EXPECT_EQ(report.memory[0].weights, 4 * (static_cast<std::uint64_t>(parameters) + text));
    EXPECT_EQ(report.memory[1].weights, 2 * static_cast<std::uint64_t>(parameters) + 4 * text);
    EXPECT_EQ(report.resolution, pipeline.native_size());
    EXPECT_EQ(report.condition_channels, pipeline.condition_channels());
}

TEST_F(Verify, WhatIsMissingIsNamed) {
    fs::remove(prior() / unet);
    expect_problem("contains no weights");
    write_file(prior() / "unet/diffusion_pytorch_model.bin", "");
    expect_problem("is a pickle");
    fs::remove_all(prior() / "unet");
    expect_problem("unet: no such folder");
    fs::remove(prior() / "model_index.json");
    EXPECT_NE(message_of<InputError>([&] { verify_prior(prior()); }).find("model_index.json"),
              std::string::npos);
}

TEST_F(Verify, WhatIsMisshapenIsNamed) {
    fs::resize_file(prior() / unet, fs::file_size(prior() / unet) - 4);
    expect_problem("diffusion_pytorch_model.safetensors");
}

TEST_F(Verify, WhatIsUnsupportedIsNamed) {
    change("model_index.json", "AutoencoderKL", "AutoencoderDC");
    expect_problem("AutoencoderDC is not supported");
}

TEST_F(Verify, AnInpaintingNetworkIsTakenForNoneThatIsToldAShape) {
    change("unet/config.json", "\"in_channels\": 4", "\"in_channels\": 9");
    NamedTensors tensors = SafeTensors::open(prior() / unet).tensors();
    for (auto& [name, value] : tensors)
        if (name == "conv_in.weight")
            value = at::cat({value, at::zeros({value.size(0), 5, 3, 3})}, 1);
    save_safetensors(prior() / unet, tensors);
    EXPECT_FALSE(takes_shape(Pipeline::load(prior())));
    expect_problem("5 additional input channels (for inpainting");
}

TEST_F(Verify, ANeededPartThatTheIndexDoesNotNameIsSaid) {
    change("model_index.json", "\"scheduler\"", "\"schedule\"");
    expect_problem("\"scheduler\": is missing");
}

TEST_F(Verify, ConfigurationsThatLieAboutSizesAreFound) {
    // The config describes a network a hundred thousand times as large, for which nothing may be
    // allocated.
    change("unet/config.json", "\"cross_attention_dim\": ", "\"cross_attention_dim\": 1");
    const PriorReport report = verify_prior(prior());
    EXPECT_FALSE(report.usable());
    EXPECT_NE(report.problems[0].find("unet"), std::string::npos) << report.problems[0];
}

TEST_F(Verify, EachPartHasItsOwnLine) {
    fs::remove(prior() / "vae/config.json");
    fs::remove(prior() / "tokenizer/vocab.json");
    fs::resize_file(prior() / "text_encoder/model.safetensors", 20);
    EXPECT_EQ(verify_prior(prior()).problems.size(), 3u);
}

}  // namespace
}  // namespace item3d
