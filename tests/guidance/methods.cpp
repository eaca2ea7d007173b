// Tests of each method against its formula, which is implemented here again with one U-Net row at a
// time.
#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/guidance/sdi.h"
#include "item3d/guidance/timestep_schedule.h"
#include "tests/support/guidance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d::testing {
namespace {

const std::string source_prompt = "a toy duck";
const std::string target_prompt = "a Mallard";
constexpr double formula_tolerance = 2e-4;

/// Returns a beta of Stable Diffusion's schedule, which two numbers define.
double beta(std::int64_t i) {
    const double first = std::sqrt(0.00085), last = std::sqrt(0.012);
    return std::pow(first + static_cast<double>(i) / 999 * (last - first), 2);
}

double alpha_bar(std::int64_t t) {
    double product = 1;
    for (std::int64_t i = 0; i <= t; ++i)
        product *= 1 - beta(i);
    return product;
}

at::Tensor noised(const at::Tensor& clean, const at::Tensor& noise, double alpha) {
    return std::sqrt(alpha) * clean + std::sqrt(1 - alpha) * noise;
}

at::Tensor cleaned(const at::Tensor& noisy, const at::Tensor& noise, double alpha) {
    return (noisy - std::sqrt(1 - alpha) * noise) / std::sqrt(alpha);
}

class GuidanceMethod : public ::testing::Test {
  protected:
    static void SetUpTestSuite() { pipeline_ = load_pipeline(); }
    static void TearDownTestSuite() { pipeline_.reset(); }

    GuidanceMethod() : input_(random_input(11)) {
        options_.adjust = Adjustment::off;
        options_.iterations = 100;
        options_.seed = 5;
    }

    at::Tensor gradient(const std::string& method, std::int64_t iteration) {
        options_.method = method;
        return make_guidance(pipeline_, source_prompt, target_prompt, options_)
            ->step(input_, iteration)
            .latents_gradient;
    }

    at::Tensor eps(const at::Tensor& noisy, std::int64_t t, const std::string& prompt) const {
        const auto timesteps = at::full({noisy.size(0)}, t, at::kLong);
        return pipeline_->predict_noise(noisy, timesteps, pipeline_->encode_text({prompt}));
    }
    at::Tensor guided(const at::Tensor& noisy, std::int64_t t, const std::string& prompt, double w,
                      const std::string& base = "") const {
        return (1 - w) * eps(noisy, t, base) + w * eps(noisy, t, prompt);
    }
    at::Tensor latents(const at::Tensor& images) const {
        return pipeline_->encode_image(images * 2 - 1).detach();
    }
    /// Returns the noised latents of an iteration.
    NoisedLatents start(std::int64_t iteration) const {
        return noise_latents(*pipeline_, input_, options_, iteration);
    }
    static std::int64_t timestep_of(const NoisedLatents& start) {
        return start.timesteps[0].item<std::int64_t>();
    }

    static inline std::shared_ptr<const Pipeline> pipeline_;
    const at::NoGradGuard no_grad_;
    GuidanceInput input_;
    GuidanceOptions options_;
};

TEST_F(GuidanceMethod, DdsIsTheDifferenceOfTwoGuidedPredictions) {
    for (const char* negative : {"", "grey"}) {
        options_.negative_prompt = negative;
        const NoisedLatents drawn = start(4);
        const std::int64_t t = timestep_of(drawn);
        const double alpha = alpha_bar(t);
        const at::Tensor expected = guided(noised(latents(input_.images), drawn.noise, alpha), t,
                                           target_prompt, 7.5, negative) -
                                    guided(noised(latents(input_.reference), drawn.noise, alpha), t,
                                           source_prompt, 7.5, negative);
        EXPECT_LT(relative_error(gradient("dds", 4), expected), formula_tolerance) << negative;
    }
}

TEST_F(GuidanceMethod, DdsWithoutAnEditIsRelativeDirection) {
    input_.reference = input_.images.detach();
    options_.weighting = Weighting::uniform;
    EXPECT_LT(relative_error(gradient("dds", 2), gradient("rdl", 2)), formula_tolerance);
}

TEST_F(GuidanceMethod, PdsIsTheDifferenceOfStochasticLatents) {
    options_.guidance_scale = 30;
    for (const std::int64_t iteration : {0, 1, 2}) {
        const NoisedLatents drawn = start(iteration);
        const std::int64_t k = timestep_of(drawn) / 2, t = 2 * k + 1, before = t - 2;
        const double a = alpha_bar(t), b = alpha_bar(before);
        const at::Tensor second = iteration_draws(options_, iteration).normal_like(drawn.noise);
        const auto stochastic = [&](const at::Tensor& z, const std::string& prompt) {
            const at::Tensor z_t = noised(z, drawn.noise, a), z_b = noised(z, second, b);
            const at::Tensor clean = cleaned(z_t, guided(z_t, t, prompt, 30), a);
            const at::Tensor mean = std::sqrt(b) * beta(t) / (1 - a) * clean +
                                    std::sqrt(1 - beta(t)) * (1 - b) / (1 - a) * z_t;
            return (z_b - mean) / std::sqrt((1 - b) / (1 - a) * beta(t));
        };
        const at::Tensor expected = stochastic(latents(input_.images), target_prompt) -
                                    stochastic(latents(input_.reference), source_prompt);
        EXPECT_FALSE(at::allclose(second, drawn.noise));
        // The divisor is as low as 0.03 and amplifies the float32 error of z_b - mean.
        EXPECT_LT(relative_error(gradient("pds", iteration), expected), 2e-3) << t;
    }
}

TEST_F(GuidanceMethod, WhatComparesWithTheReferenceNeedsIt) {
    for (const std::string& method : guidance_methods()) {
        options_.method = method;
        const auto guidance = make_guidance(pipeline_, source_prompt, target_prompt, options_);
        GuidanceInput without = random_input(1);
        without.reference.reset();
        const bool compares = method == "dds" || method == "pds";
        EXPECT_EQ(guidance->needs_reference(), compares) << method;
        if (compares)
            EXPECT_ANY_THROW(guidance->step(without, 0)) << method;
        else
            EXPECT_NO_THROW(guidance->step(without, 0)) << method;
    }
}

TEST_F(GuidanceMethod, WhatComparesWithTheReferenceRestsWhereNothingIsAsked) {
    input_.reference = input_.images.detach();
    for (const char* method : {"dds", "pds"}) {
        options_.method = method;
        const auto guidance = make_guidance(pipeline_, "a mug", "a mug", options_);
        EXPECT_LT(guidance->step(input_, 3).latents_gradient.abs().max().item<float>(), 1e-4f)
            << method;
    }
}

TEST_F(GuidanceMethod, PdsPullsBackToTheReference) {
    // The prompts are equal, so the gradient is mostly the identity term, whose negative points to
    // the reference.
    options_.method = "pds";
    options_.guidance_scale = 1;
    const auto guidance = make_guidance(pipeline_, "a mug", "a mug", options_);
    const at::Tensor away = latents(input_.images) - latents(input_.reference);
    EXPECT_GT((guidance->step(input_, 3).latents_gradient * away).sum().item<float>(), 0.0f);
}

TEST_F(GuidanceMethod, NfsdDropsTheNegativePromptWhereThereIsLittleNoise) {
    options_.weighting = Weighting::dreamfusion;
    for (const auto& [low, high] : {std::pair{0.12f, 0.19f}, std::pair{0.2f, 0.28f}}) {
        options_.min_timestep = low;
        options_.max_timestep = high;
        const NoisedLatents drawn = start(4);
        const std::int64_t t = timestep_of(drawn);
        const double alpha = alpha_bar(t);
        const at::Tensor noisy = noised(latents(input_.images), drawn.noise, alpha);
        at::Tensor expected = eps(noisy, t, "");
        if (t >= 200) {
            expected = expected - eps(noisy, t,
                                      "unrealistic, blurry, low quality, out of focus, ugly, low "
                                      "contrast, dull, dark, low-resolution, gloomy");
        }
        expected =
            (1 - alpha) * (expected + 7.5 * (eps(noisy, t, target_prompt) - eps(noisy, t, "")));
        EXPECT_LT(relative_error(gradient("nfsd", 4), expected), formula_tolerance) << t;
    }
}

TEST_F(GuidanceMethod, CsdChangesItsCoefficientsAndTimesteps) {
    options_.negative_prompt = "grey";
    for (const std::int64_t iteration : {0, 10, 60, 99}) {
        const double progress = static_cast<double>(iteration) / 100;
        const GuidanceOptions usual = options_;
        options_.min_timestep = progress < 0.25 ? 0.2f : 0.02f;
        options_.max_timestep = progress < 0.25 ? 0.8f : 0.5f;
        const NoisedLatents drawn = start(iteration);
        options_ = usual;
        const std::int64_t t = timestep_of(drawn);
        const double alpha = alpha_bar(t);
        const at::Tensor noisy = noised(latents(input_.images), drawn.noise, alpha);
        const double u = -1 + 0.5 * progress, n = -0.5 * progress;
        const at::Tensor expected =
            (1 - alpha) * (1.05 * eps(noisy, t, target_prompt) + u * eps(noisy, t, "grey") +
                           n * eps(noisy, t, ""));
        EXPECT_LT(relative_error(gradient("csd", iteration), expected), formula_tolerance) << t;
    }
}

TEST_F(GuidanceMethod, IsmFollowsOnePath) {
    for (const std::int64_t iteration : {0, 15, 80}) {
        const double warm_up = std::max(0.0, 1 - static_cast<double>(iteration) / 30);
        const GuidanceOptions usual = options_;
        options_.max_timestep = static_cast<float>((500 + 480 * warm_up) / 1000);
        const NoisedLatents drawn = start(iteration);
        options_ = usual;
        const std::int64_t t = timestep_of(drawn);
        const auto delta = static_cast<std::int64_t>(std::ceil(80 + 20 * warm_up - 1e-9));
        const std::int64_t s = std::max<std::int64_t>(t - delta, 0);
        const at::Tensor offset =
            iteration_draws(options_, iteration).normal_like(at::zeros({2, 4, 1, 1}));
        at::Tensor x = noised(latents(input_.images), drawn.noise + 0.1 * offset, alpha_bar(0));
        std::int64_t now = 0;
        for (int i = 0; i < 5 && now < s; ++i) {
            const std::int64_t next = std::min<std::int64_t>(now + 200, s);
            const at::Tensor e = eps(x, now, "");
            x = noised(cleaned(x, e, alpha_bar(now)), e, alpha_bar(next));
            now = next;
        }
        const at::Tensor lower = eps(x, s, "");
        x = noised(cleaned(x, lower, alpha_bar(s)), lower, alpha_bar(t));
        const at::Tensor expected = std::sqrt((1 - alpha_bar(t)) / alpha_bar(t)) *
                                    (guided(x, t, target_prompt, 7.5) - lower);
        EXPECT_LT(relative_error(gradient("ism", iteration), expected), formula_tolerance) << t;
    }
}

TEST_F(GuidanceMethod, SdiInvertsWithThePromptAndComparesWithWhatIsClean) {
    options_.guidance_scale = 8.5f;
    options_.min_timestep = 0.25f;
    options_.timestep_schedule = TimestepSchedule::anneal;
    for (const std::int64_t iteration : {0, 70}) {
        const auto t = static_cast<std::int64_t>(
            1000 * (0.25 + 0.73 * (1 - static_cast<double>(iteration) / 100)));
        ASSERT_EQ(timestep_of(start(iteration)), t);
        IterationDraws draws = iteration_draws(options_, iteration);
        std::vector<std::int64_t> levels{-99};
        for (std::int64_t k = 0; k < 10 && 1 + 100 * k < t; ++k)
            levels.push_back(1 + 100 * k);
        levels.push_back(std::min<std::int64_t>(
            t + static_cast<std::int64_t>(std::floor(100 * draws.uniform)), 999));
        const InversionDistillation method(pipeline_, target_prompt, options_);
        EXPECT_EQ(method.inversion_levels(t, draws.uniform), levels);

        const at::Tensor z = latents(input_.images);
        at::Tensor x = z;
        for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
            const std::int64_t from = std::max<std::int64_t>(levels[i], 0);
            const double a = alpha_bar(from), b = alpha_bar(levels[i + 1]);
            const at::Tensor e = guided(x, from, target_prompt, -6.5);
            x = noised(cleaned(x, e, a), e, b) +
                0.3 * std::sqrt((1 - a) / (1 - b) * (1 - b / a)) * draws.normal_like(x);
        }
        const at::Tensor expected = z - cleaned(x, guided(x, t, target_prompt, 8.5), alpha_bar(t));
        EXPECT_LT(relative_error(gradient("sdi", iteration), expected), 1e-3) << t;
    }
}

TEST(TimestepSchedule, UniformIsDrawnBetweenTheTwoEnds) {
    GuidanceOptions options;
    options.seed = 9;
    options.min_timestep = 0.1f;
    options.max_timestep = 0.7f;
    const auto pipeline = load_pipeline();
    for (const std::uint64_t iteration : {0, 1, 2, 50}) {
        const auto expected = static_cast<std::int64_t>(
            Random(9, 1, 2 * iteration).uniform(0.1f * 1000.0, 0.7f * 1000.0));
        const NoisedLatents start = noise_latents(*pipeline, random_input(1), options,
                                                  static_cast<std::int64_t>(iteration));
        EXPECT_EQ(start.timesteps[0].item<std::int64_t>(), expected);
        EXPECT_EQ(start.timesteps[1].item<std::int64_t>(), expected);
    }
}

TEST(TimestepSchedule, AnnealFallsLinearly) {
    GuidanceOptions options;
    options.timestep_schedule = parse_timestep_schedule("anneal");
    options.iterations = 5;
    options.min_timestep = 0.2f;
    options.max_timestep = 0.8f;
    std::vector<std::int64_t> timesteps;
    for (std::int64_t i = 0; i < 5; ++i)
        timesteps.push_back(scheduled_timestep(options, 1000, i, 0.5));
    EXPECT_EQ(timesteps, (std::vector<std::int64_t>{800, 680, 560, 440, 320}));
    options.max_timestep = 1;
    EXPECT_EQ(scheduled_timestep(options, 1000, 0, 0.5), 999);
}

TEST(TimestepSchedule, DreamtimeSharesOutItsWeight) {
    GuidanceOptions options;
    options.timestep_schedule = parse_timestep_schedule("dreamtime");
    options.iterations = 40;
    const auto weight = [](double t) {
        if (t > 800) return std::exp(-(t - 800) * (t - 800) / (2 * 300.0 * 300.0));
        if (t >= 500) return 1.0;
        return std::exp(-(t - 500) * (t - 500) / (2 * 500.0 * 500.0));
    };
    double total = 0;
    for (int t = 20; t <= 980; ++t)
        total += weight(t);
    std::int64_t last = 980;
    for (std::int64_t i = 0; i < 40; ++i) {
        int nearest = 0;
        double distance = 2;
        for (int t = 20; t <= 980; ++t) {
            double above = 0;
            for (int u = t; u <= 980; ++u)
                above += weight(u) / total;
            const double apart = std::abs(above - static_cast<double>(i) / 40);
            if (apart >= distance) continue;
            distance = apart;
            nearest = t;
        }
        const std::int64_t t = scheduled_timestep(options, 1000, i, 0.5);
        EXPECT_NEAR(static_cast<double>(t), nearest, 1) << i;  // rounding may break ties
        EXPECT_LE(t, last);
        last = t;
    }
    EXPECT_EQ(scheduled_timestep(options, 1000, 0, 0.5), 980);
    EXPECT_LT(last, 100);
    EXPECT_THROW(parse_timestep_schedule("sometimes"), InputError);
}

}  // namespace
}  // namespace item3d::testing
