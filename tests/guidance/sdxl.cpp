#include "item3d/guidance/guidance.h"
#include "item3d/networks/diffusion/pipeline.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace item3d {
namespace {

/// Sets one thread, because the network is too small for more.
[[maybe_unused]] const bool one_thread = [] {
    at::set_num_threads(1);
    return true;
}();

std::shared_ptr<const Pipeline> load_sdxl() {
    return std::make_shared<Pipeline>(
        Pipeline::load(std::filesystem::path(ITEM3D_TEST_DATA) / "models" / "pipeline_sdxl"));
}

GuidanceInput random_images(std::uint64_t seed) {
    at::manual_seed(seed);
    GuidanceInput input;
    input.images = at::rand({2, 3, 32, 32}).requires_grad_(true);
    return input;
}

at::Tensor find(const NamedTensors& state, const std::string& name) {
    for (const auto& [key, tensor] : state)
        if (key == name) return tensor;
    ADD_FAILURE() << "no " << name;
    return at::zeros({1});
}

}  // namespace

TEST(GuidanceSdxl, EveryMethodReachesThePictures) {
    const auto pipeline = load_sdxl();
    std::vector<std::pair<std::string, Adjustment>> cases{{"rdl", Adjustment::learned}};
    for (const std::string& method : guidance_methods())
        cases.emplace_back(method, Adjustment::off);
    for (const auto& [method, adjust] : cases) {
        GuidanceOptions options;
        options.method = method;
        options.adjust = adjust;
        const auto guidance = make_guidance(pipeline, "a red bowl", "a stone statue", options);
        GuidanceInput input = random_images(1);
        input.reference = at::rand({2, 3, 32, 32});
        const GuidanceOutput output = guidance->step(input, 0);
        output.latents.backward(output.latents_gradient);
        EXPECT_TRUE(at::isfinite(input.images.grad()).all().item<bool>()) << method;
        EXPECT_GT(input.images.grad().abs().max().item<float>(), 0.0f) << method;
    }
}

TEST(GuidanceSdxl, ThePooledPartOfAPromptCounts) {
    const auto pipeline = load_sdxl();
    TextEmbedding text = pipeline->encode_text({"a red bowl"});
    const at::Tensor latents = at::zeros({1, 4, 4, 4}), t = at::tensor({500}, at::kLong);
    const at::NoGradGuard no_grad;
    const at::Tensor before = pipeline->predict_noise(latents, t, text);
    text.pooled = text.pooled + 1;
    EXPECT_FALSE(at::allclose(pipeline->predict_noise(latents, t, text), before));
}

TEST(GuidanceSdxl, TheLearnedSourceMovesBothPartsAndSurvivesACheckpoint) {
    const auto pipeline = load_sdxl();
    const auto guidance = make_guidance(pipeline, "a red bowl", "a stone statue", {});
    const TextEmbedding start = pipeline->encode_text({"a red bowl"});
    const GuidanceInput input = random_images(4);
    const float before = guidance->step(input, 0).source_loss;
    float after = 0;
    for (int i = 0; i < 12; ++i)
        after = guidance->step(input, 0).source_loss;
    EXPECT_LT(after, before);
    NamedTensors copy;
    for (const auto& [name, tensor] : guidance->state())
        copy.emplace_back(name, tensor.clone());
    EXPECT_FALSE(at::allclose(find(copy, "source.embedding"), start.states));
    EXPECT_FALSE(at::allclose(find(copy, "source.pooled_embedding"), start.pooled));

    const auto resumed = make_guidance(pipeline, "a red bowl", "a stone statue", {});
    resumed->load_state(copy);
    EXPECT_TRUE(at::equal(guidance->step(input, 1).latents_gradient,
                          resumed->step(input, 1).latents_gradient));
}

}  // namespace item3d
