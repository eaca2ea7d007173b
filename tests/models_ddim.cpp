#include "item3d/core/error.h"
#include "item3d/models/ddim.h"
#include "models_testing.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;

class Ddim : public ::testing::TestWithParam<const char*> {};

TEST_P(Ddim, ReproducesTheReference) {
    const Golden golden("schedulers");
    const torch::Tensor sample = golden.in("sample"), noise = golden.in("noise");
    for (const auto& [kind, eta] : {std::pair("ddim", 0.0), std::pair("ddim_eta", 0.6)}) {
        const std::string prefix = std::string(GetParam()) + "." + kind + ".";
        DdimScheduler scheduler = DdimScheduler::load(fixture("schedulers") / GetParam() / kind);
        if (eta == 0.0) {
            golden.expect(prefix + "alphas_cumprod", scheduler.alphas_cumprod(), 1e-5);
            std::vector<torch::Tensor> noisy, velocity;
            const torch::Tensor timesteps = golden.in("noise_timesteps");
            for (std::int64_t i = 0; i < timesteps.size(0); ++i) {
                const torch::Tensor rows = timesteps[i].expand({sample.size(0)});
                noisy.push_back(scheduler.add_noise(sample, noise, rows));
                velocity.push_back(scheduler.get_velocity(sample, noise, rows));
            }
            golden.expect(prefix + "add_noise", torch::stack(noisy), 1e-5);
            golden.expect(prefix + "get_velocity", torch::stack(velocity), 1e-5);
        }
        scheduler.set_timesteps(10);
        golden.expect(prefix + "timesteps", torch::tensor(scheduler.timesteps()), 0);
        torch::Tensor current = sample;
        std::vector<torch::Tensor> trajectory;
        for (int i = 0; i < 10; ++i) {
            current = scheduler.step(golden.in("model_outputs")[i], scheduler.timesteps()[i],
                                     current, eta, golden.in("step_noise")[i]);
            trajectory.push_back(current);
        }
        golden.expect(prefix + "prev_sample", torch::stack(trajectory), 1e-5);
    }
}

INSTANTIATE_TEST_SUITE_P(Configs, Ddim,
                         ::testing::Values("sd15", "sd21_v", "sd21_v_ztsnr", "sdxl"));

TEST(DdimScheduler, ConvertsEveryPredictionToTheSameNoise) {
    torch::manual_seed(7);
    const torch::Tensor clean = torch::randn({2, 4, 3, 3}), noise = torch::randn({2, 4, 3, 3});
    const torch::Tensor timesteps = torch::tensor({100, 900});
    for (const char* type : {"epsilon", "v_prediction", "sample"}) {
        const DdimScheduler scheduler(DdimConfig::stable_diffusion(type));
        const torch::Tensor noisy = scheduler.add_noise(clean, noise, timesteps);
        const torch::Tensor output = type == std::string("epsilon") ? noise
                                     : type == std::string("sample")
                                         ? clean
                                         : scheduler.get_velocity(clean, noise, timesteps);
        EXPECT_LT(testing::largest_difference(scheduler.to_noise(output, noisy, timesteps), noise),
                  1e-5)
            << type;
    }
}

TEST(DdimScheduler, PerfectPredictionsLeadToTheCleanSample) {
    torch::manual_seed(8);
    const torch::Tensor clean = torch::randn({1, 4, 3, 3}), noise = torch::randn({1, 4, 3, 3});
    for (const char* spacing : {"leading", "trailing", "linspace"}) {
        DdimConfig config = DdimConfig::stable_diffusion("v_prediction");
        config.timestep_spacing = spacing;
        config.set_alpha_to_one = true;
        config.steps_offset = 0;
        DdimScheduler scheduler(config);
        scheduler.set_timesteps(8);  // divides 1000, so that trailing ends clean
        torch::Tensor sample =
            scheduler.add_noise(clean, noise, torch::tensor({scheduler.timesteps()[0]}));
        for (const std::int64_t timestep : scheduler.timesteps()) {
            const double alpha = scheduler.alphas_cumprod()[timestep].item<double>();
            const torch::Tensor rest = (sample - std::sqrt(alpha) * clean) / std::sqrt(1 - alpha);
            const torch::Tensor velocity =
                scheduler.get_velocity(clean, rest, torch::tensor({timestep}));
            sample = scheduler.step(velocity, timestep, sample);
        }
        EXPECT_LT(testing::largest_difference(sample, clean), 0.05) << spacing;
    }
}

TEST(DdimConfig, ReadsOtherSchedulersAndSurvivesWriting) {
    const auto config = DdimConfig::from_json({{"_class_name", "PNDMScheduler"},
                                               {"beta_schedule", "scaled_linear"},
                                               {"beta_start", 0.00085},
                                               {"beta_end", 0.012},
                                               {"skip_prk_steps", true}});
    EXPECT_FALSE(config.clip_sample);
    EXPECT_FALSE(config.set_alpha_to_one);
    EXPECT_EQ(DdimConfig::from_json(config.to_json()).to_json(), config.to_json());
    EXPECT_THROW(DdimConfig::from_json({{"prediction_type", "flow"}}), InputError);
    EXPECT_THROW(DdimConfig::from_json({{"beta_end", 2}}), InputError);
    EXPECT_THROW(DdimConfig::from_json({{"num_train_timesteps", 1000000000}}), InputError);
}

TEST(DdimConfig, TakesInfinitiesAsPythonWritesThem) {
    const testing::TemporaryFolder folder;
    const auto path = folder.path() / "scheduler_config.json";
    testing::write_file(
        path, R"({"lambda_min_clipped": -Infinity, "note": "NaN \" Infinity", "x": NaN})");
    EXPECT_EQ(DdimScheduler::load(folder.path()).config().num_train_timesteps, 1000);
    EXPECT_EQ(Config::read(path).text("note", ""), "NaN \" Infinity");
    testing::write_file(path, R"({"beta_start": NaN})");
    EXPECT_THROW(DdimScheduler::load(folder.path()), InputError);
    testing::write_file(path, R"({"beta_start": Infinite)");
    EXPECT_THROW(DdimScheduler::load(folder.path()), InputError);
}

}  // namespace
}  // namespace item3d
