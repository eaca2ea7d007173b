#include "item3d/guidance/rdl.h"

#include "item3d/core/error.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/tensors/safetensors.h"
#include "tests/support/guidance.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace item3d {
namespace {

using testing::load_pipeline;
using testing::random_input;
using testing::relative_error;

const std::filesystem::path step_file =
    std::filesystem::path(ITEM3D_TEST_DATA) / "guidance" / "rdl_step.safetensors";

constexpr double tolerance = 5e-5;  // relative to max(1, largest value); advised for rdl_step

/// Returns the recorded step's latents, noise and timesteps, in the form of noise_latents.
NoisedLatents recorded_start(const Pipeline& pipeline, const SafeTensors& file) {
    NoisedLatents start;
    start.latents = file.tensor("out.latents");
    start.noise = file.tensor("in.noise");
    start.timesteps = file.tensor("in.t");
    start.alphas_cumprod = pipeline.schedule().alphas_at(start.timesteps);
    start.noisy = pipeline.schedule().add_noise(start.latents, start.noise, start.timesteps);
    return start;
}

}  // namespace

TEST(RelativeDirection, TwoRowsEqualTheFourRowFormWithItsSourceBranchPutRight) {
    const auto pipeline = load_pipeline();
    const SafeTensors file = SafeTensors::open(step_file);
    const NoisedLatents start = recorded_start(*pipeline, file);
    const float w = 7.5f;
    const TextEmbedding text =
        pipeline->encode_text({"a Mallard, front view", "a toy duck, front view"});
    const PromptPair pair = predict_pair(*pipeline, start, text.row(0), text.row(1));

    EXPECT_LT(relative_error(pair.target, file.tensor("out.eps_target_cond")), tolerance);
    EXPECT_LT(relative_error(pair.source, file.tensor("out.eps_source_cond")), tolerance);
    const at::Tensor four_rows =
        file.tensor("out.eps_target") - file.tensor("out.eps_source_base_uncond");
    EXPECT_LT(relative_error(w * (pair.target - pair.source), four_rows), 1e-4);
    for (const auto& [weighting, name] :
         {std::pair{Weighting::early, "early"}, std::pair{Weighting::late, "late"}}) {
        const at::Tensor gradient =
            timestep_weight(weighting, start.alphas_cumprod) * w * (pair.target - pair.source);
        EXPECT_LT(
            relative_error(gradient, file.tensor(std::string("out.grad_latents_uncond_") + name)),
            1e-4);
    }
}

TEST(RelativeDirection, DiffersFromThePublishedSourceBranch) {
    const SafeTensors file = SafeTensors::open(step_file);
    const at::Tensor right = file.tensor("out.grad_latents_uncond_early");
    const at::Tensor published = file.tensor("out.grad_latents_text_early");
    EXPECT_GT(relative_error(published, right), 100 * tolerance);
}

TEST(Guidance, SameSeedAndIterationGiveTheSameGradient) {
    const auto pipeline = load_pipeline();
    for (const std::string& method : guidance_methods()) {
        GuidanceOptions options;
        options.method = method;
        options.seed = 7;
        const auto first = make_guidance(pipeline, "a red mug", "a blue mug", options);
        const auto second = make_guidance(pipeline, "a red mug", "a blue mug", options);
        const GuidanceInput input = random_input(3);
        const auto a = first->step(input, 5).latents_gradient;
        const auto b = second->step(input, 5).latents_gradient;
        const auto other = second->step(input, 6).latents_gradient;
        EXPECT_TRUE(at::equal(a, b)) << method;
        EXPECT_FALSE(at::allclose(a, other)) << method;
    }
}

TEST(Guidance, TheSameTwoPromptsHaveNoDirection) {
    GuidanceOptions options;
    options.adjust = Adjustment::off;
    const auto guidance = make_guidance(load_pipeline(), "a mug", "a mug", options);
    EXPECT_LT(guidance->step(random_input(1), 0).latents_gradient.abs().max().item<float>(), 1e-4f);
}

TEST(Guidance, ANegativePromptTakesTheEmptyOnesPlaceInSdsAndCancelsInRdl) {
    const auto pipeline = load_pipeline();
    const GuidanceInput input = random_input(3);
    const auto gradient = [&](const std::string& method, const std::string& negative) {
        GuidanceOptions options;
        options.method = method;
        options.negative_prompt = negative;
        return make_guidance(pipeline, "a toy duck", "a Mallard", options)
            ->step(input, 4)
            .latents_gradient;
    };
    EXPECT_TRUE(gradient("rdl", "grey").equal(gradient("rdl", "")));

    const NoisedLatents start = noise_latents(*pipeline, input, {}, 4);
    const auto predict = [&](const std::string& prompt) {
        return pipeline->predict_noise(start.noisy, start.timesteps,
                                       pipeline->encode_text({prompt}));
    };
    const at::NoGradGuard no_grad;
    const at::Tensor base = predict("grey");
    const at::Tensor wanted =
        start.weight * (base + 7.5f * (predict("a Mallard") - base) - start.noise);
    EXPECT_LT(relative_error(gradient("sds", "grey"), wanted), 1e-4);
    EXPECT_GT(relative_error(gradient("sds", ""), wanted), 1e-3);
}

TEST(Guidance, LatentsCarryGradientsToTheImages) {
    const auto guidance = make_guidance(load_pipeline(), "a red mug", "a blue mug", {});
    const GuidanceInput input = random_input(2);
    const GuidanceOutput output = guidance->step(input, 0);
    output.latents.backward(output.latents_gradient);
    EXPECT_GT(input.images.grad().abs().max().item<float>(), 0.0f);
    EXPECT_FALSE(output.latents_gradient.requires_grad());
}

TEST(LearnedSource, LowersTheDenoisingLossAndSurvivesACheckpoint) {
    const auto pipeline = load_pipeline();
    GuidanceOptions options;
    const auto guidance = make_guidance(pipeline, "a red mug", "a blue mug", options);
    const GuidanceInput input = random_input(4);
    const float before = guidance->step(input, 0).source_loss;
    float after = 0;
    for (int i = 0; i < 30; ++i)
        after = guidance->step(input, 0).source_loss;
    EXPECT_LT(after, before);

    const auto resumed = make_guidance(pipeline, "a red mug", "a blue mug", options);
    NamedTensors copy;
    for (const auto& [name, tensor] : guidance->state())
        copy.emplace_back(name, tensor.clone());
    resumed->load_state(copy);
    EXPECT_TRUE(at::equal(guidance->step(input, 1).latents_gradient,
                          resumed->step(input, 1).latents_gradient));
}

TEST(LearnedSource, MoreSamplesChangeItsStepButNotTheFirstPrediction) {
    const auto pipeline = load_pipeline();
    GuidanceOptions one, four;
    four.adjust_samples = 4;
    const auto narrow = make_guidance(pipeline, "a red mug", "a blue mug", one);
    const auto wide = make_guidance(pipeline, "a red mug", "a blue mug", four);
    const GuidanceInput input = random_input(4);
    const auto gradient = [&](Guidance& guidance, int iteration) {
        return guidance.step(input, iteration).latents_gradient;
    };
    EXPECT_LT(relative_error(gradient(*wide, 0), gradient(*narrow, 0)), 1e-4);
    EXPECT_GT(relative_error(gradient(*wide, 1), gradient(*narrow, 1)), 1e-3);
}

TEST(NoisedLatents, RenoisedRowsSpreadOverTheTimesteps) {
    const auto pipeline = load_pipeline();
    GuidanceOptions options;
    options.min_timestep = 0.2f;
    options.max_timestep = 0.6f;
    const NoisedLatents start = noise_latents(*pipeline, random_input(5), options, 0);
    const NoisedLatents more = renoise_latents(*pipeline, start, options, 0, 4);
    const auto steps = static_cast<double>(pipeline->schedule().alphas_cumprod().size(0));
    ASSERT_EQ(more.timesteps.size(0), 8);
    for (std::int64_t i = 0; i < 8; ++i) {
        const double part = static_cast<double>(more.timesteps[i].item<std::int64_t>()) / steps;
        const double quarter = 0.2 + 0.1 * static_cast<double>(i % 4);
        EXPECT_GE(part, quarter - 1.0 / steps);
        EXPECT_LE(part, quarter + 0.1);
    }
    EXPECT_TRUE(at::equal(more.latents[0], more.latents[3]));
    EXPECT_FALSE(at::allclose(more.noise[0], more.noise[1]));
    EXPECT_FALSE(more.noisy.requires_grad());
}

TEST(Guidance, EmptyPromptsAndUnknownNamesAreRefused) {
    const auto pipeline = load_pipeline();
    EXPECT_THROW(make_guidance(pipeline, " ", "a mug", {}), InputError);
    EXPECT_THROW(make_guidance(pipeline, "a mug", "", {}), InputError);
    GuidanceOptions options;
    options.method = "magic";
    EXPECT_THROW(make_guidance(pipeline, "a mug", "a cup", options), InputError);
    EXPECT_THROW(parse_weighting("heavy"), InputError);
}

}  // namespace item3d
