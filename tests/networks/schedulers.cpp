#include "item3d/core/error.h"
#include "item3d/networks/diffusion/samplers/sampler.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;

constexpr double tolerance = 1e-5;  // relative to the largest value of the recording

/// Parameters: the configuration of a recorded case, and one of its kinds.
class RecordedScheduler : public ::testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(RecordedScheduler, AgreesWithTheReference) {
    const Golden golden("schedulers");
    const auto& [config, kind] = GetParam();
    const std::string prefix = std::string(config) + "." + kind + ".";
    const NoiseSchedule schedule = NoiseSchedule::load(fixture("schedulers") / config / kind);
    const at::Tensor sample = golden.in("sample"), noise = golden.in("noise");
    const at::Tensor noise_timesteps = golden.in("noise_timesteps");
    const auto expect_if_recorded = [&](const std::string& name, const at::Tensor& actual) {
        if (golden.has("out." + prefix + name)) golden.expect(prefix + name, actual, tolerance);
    };
    expect_if_recorded("alphas_cumprod", schedule.alphas_at(noise_timesteps).flatten());
    std::vector<at::Tensor> noisy, velocities;
    for (std::int64_t i = 0; i < noise_timesteps.size(0); ++i) {
        const at::Tensor t = noise_timesteps.narrow(0, i, 1);
        noisy.push_back(schedule.add_noise(sample, noise, t));
        velocities.push_back(schedule.get_velocity(sample, noise, t));
    }
    expect_if_recorded("add_noise", at::stack(noisy));
    expect_if_recorded("get_velocity", at::stack(velocities));

    const auto sampler =
        make_sampler(schedule, {.steps = 10, .eta = kind == std::string("ddim_eta") ? 0.6 : 0.0});
    std::vector<double> timesteps;
    std::vector<at::Tensor> scaled, trajectory, starts;
    at::Tensor current = sample * sampler->initial_scale();
    for (int i = 0; i < sampler->steps(); ++i) {
        timesteps.push_back(sampler->timestep(i));
        scaled.push_back(sampler->scale_input(i, current));
        current =
            sampler->step(i, golden.in("model_outputs")[i], current, golden.in("step_noise")[i]);
        trajectory.push_back(current);
    }
    for (const int i : {0, 4, 9})
        starts.push_back(sampler->add_noise(i, sample, noise));
    golden.expect(prefix + "timesteps", at::tensor(timesteps),
                  std::string(kind) == "euler_karras" ? tolerance : 0);
    golden.expect(prefix + "init_noise_sigma", at::tensor({sampler->initial_scale()}), tolerance);
    golden.expect(prefix + "prev_sample", at::stack(trajectory), tolerance);
    expect_if_recorded("scaled_input", at::stack(scaled));
    expect_if_recorded("add_noise_schedule", at::stack(starts));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, RecordedScheduler,
    ::testing::Combine(::testing::Values("sd15", "sd21_v", "sd21_v_ztsnr", "sdxl"),
                       ::testing::Values("ddim", "ddim_eta", "ddpm", "euler", "euler_karras",
                                         "dpmpp2m", "dpmpp2m_karras", "pndm")));

TEST(NoiseSchedule, ConvertsEveryPredictionToTheSameNoiseAndImage) {
    at::manual_seed(7);
    const at::Tensor clean = at::randn({2, 4, 3, 3}), noise = at::randn({2, 4, 3, 3});
    const at::Tensor timesteps = at::tensor({600, 600}, at::kLong);
    for (const char* type : {"epsilon", "v_prediction", "sample"}) {
        const NoiseSchedule schedule(SchedulerConfig::stable_diffusion(type));
        const at::Tensor noisy = schedule.add_noise(clean, noise, timesteps);
        const at::Tensor output = type == std::string("epsilon") ? noise
                                  : type == std::string("sample")
                                      ? clean
                                      : schedule.get_velocity(clean, noise, timesteps);
        EXPECT_LT(largest_difference(schedule.to_noise(output, noisy, timesteps), noise), 1e-5)
            << type;
        const Prediction meant =
            schedule.interpret(output, noisy, schedule.alphas_cumprod()[600].item<double>());
        EXPECT_LT(largest_difference(meant.noise, noise), 1e-5) << type;
        EXPECT_LT(largest_difference(meant.clean, clean), 1e-5) << type;
    }
}

/// Runs a sampler with a stand-in for the network that knows the clean image.
at::Tensor run_with_oracle(Sampler& sampler, const at::Tensor& clean, at::Tensor sample) {
    const at::Tensor zero = at::zeros({1, 1, 1, 1}), one = at::ones({1, 1, 1, 1});
    for (int i = 0; i < sampler.steps(); ++i) {
        const at::Tensor input = sampler.scale_input(i, sample);
        double signal = sampler.add_noise(i, one, zero).item<double>();
        double deviation = sampler.add_noise(i, zero, one).item<double>();
        const double length = std::hypot(signal, deviation);
        signal /= length;
        deviation /= length;
        const at::Tensor noise = (input - signal * clean) / deviation;
        sample =
            sampler.step(i, signal * noise - deviation * clean, sample, at::randn_like(sample));
    }
    return sample;
}

TEST(Sampler, PerfectPredictionsLeadToTheCleanSample) {
    at::manual_seed(8);
    const at::Tensor clean = at::randn({1, 4, 3, 3}), noise = at::randn({1, 4, 3, 3});
    for (const SamplerKind& kind : sampler_kinds()) {
        // PNDM extrapolates, and its steps are not exactly those between linspace's timesteps.
        const double bound = kind.method == SamplerMethod::pndm ? 0.3 : 0.05;
        for (const char* spacing : {"leading", "trailing", "linspace"}) {
            SchedulerConfig config = SchedulerConfig::stable_diffusion("v_prediction");
            config.timestep_spacing = spacing;
            config.set_alpha_to_one = true;
            config.steps_offset = 0;
            const NoiseSchedule schedule(config.with_sampler(kind.name));
            for (const int skip : {0, 3}) {
                const auto sampler = make_sampler(schedule, {.steps = 8, .skip = skip});
                const at::Tensor start = sampler->add_noise(0, clean, noise);
                EXPECT_LT(largest_difference(run_with_oracle(*sampler, clean, start), clean), bound)
                    << kind.name << " " << spacing << " " << skip;
            }
        }
    }
}

TEST(Sampler, TakesAnyNumberOfSteps) {
    at::manual_seed(9);
    const at::Tensor start = at::randn({1, 1, 2, 2});
    for (const SamplerKind& kind : sampler_kinds()) {
        for (const char* spacing : {"leading", "trailing", "linspace"}) {
            SchedulerConfig config = SchedulerConfig::stable_diffusion("epsilon");
            config.timestep_spacing = spacing;
            config.num_train_timesteps = 20;
            config = config.with_sampler(kind.name);
            for (int steps = 1; steps <= max_steps(config); ++steps) {
                const auto sampler = make_sampler(NoiseSchedule(config), {.steps = steps});
                at::Tensor sample = start * sampler->initial_scale();
                for (int i = 0; i < sampler->steps(); ++i) {
                    EXPECT_GE(sampler->timestep(i), 0);
                    EXPECT_LT(sampler->timestep(i), 20);
                    sample = sampler->step(i, start, sample, start);
                }
                EXPECT_TRUE(at::isfinite(sample).all().item<bool>())
                    << kind.name << " " << spacing << " " << steps;
            }
        }
    }
}

TEST(SchedulerConfig, SurvivesWritingForEverySampler) {
    for (const SamplerKind& kind : sampler_kinds()) {
        const auto config =
            SchedulerConfig::stable_diffusion("v_prediction").with_sampler(kind.name);
        EXPECT_EQ(config.sampler_name(), kind.name);
        const auto again = SchedulerConfig::from_json(config.to_json());
        EXPECT_EQ(again.to_json(), config.to_json());
        EXPECT_EQ(again.sampler_name(), kind.name);
    }
    EXPECT_THROW(SchedulerConfig().with_sampler("heun"), InputError);
}

TEST(SchedulerConfig, DefaultsAreThoseOfTheClass) {
    const auto of = [](const char* name) {
        return SchedulerConfig::from_json({{"_class_name", name}, {"skip_prk_steps", true}});
    };
    EXPECT_EQ(of("PNDMScheduler").spacing(), "leading");
    EXPECT_FALSE(of("PNDMScheduler").clip_sample);
    EXPECT_FALSE(of("PNDMScheduler").set_alpha_to_one);
    EXPECT_TRUE(of("DDIMScheduler").clip_sample);
    EXPECT_EQ(of("EulerDiscreteScheduler").spacing(), "linspace");
    // A sampler that is requested by name uses its own class's spacing if the file names none.
    EXPECT_EQ(of("PNDMScheduler").with_sampler("dpmpp-2m").spacing(), "linspace");
}

TEST(SchedulerConfig, RefusesByKeyWhatItCannotDo) {
    const auto complaint = [](nlohmann::json json) {
        return message_of<InputError>([&] { SchedulerConfig::from_json(json); });
    };
    const auto expect_key = [&](const char* name, const char* key, const nlohmann::json& value) {
        nlohmann::json json = {{"_class_name", name}, {"skip_prk_steps", true}};
        json[key] = value;
        const std::string message = complaint(json);
        EXPECT_NE(message.find(key), std::string::npos) << message;
    };
    expect_key("DDIMScheduler", "prediction_type", "flow");
    expect_key("DDIMScheduler", "timestep_spacing", "cubic");
    expect_key("DDIMScheduler", "num_train_timesteps", 1000000000);
    expect_key("DDIMScheduler", "thresholding", true);
    expect_key("DDIMScheduler", "rescale_betas_zero_snr", true);  // not for epsilon
    expect_key("DDIMScheduler", "trained_betas", {0.1, 0.2});
    expect_key("DDPMScheduler", "variance_type", "learned_range");
    expect_key("EulerDiscreteScheduler", "timestep_type", "continuous");
    expect_key("EulerDiscreteScheduler", "use_beta_sigmas", true);
    expect_key("EulerDiscreteScheduler", "sigma_max", 700.0);
    expect_key("DPMSolverMultistepScheduler", "algorithm_type", "sde-dpmsolver++");
    expect_key("DPMSolverMultistepScheduler", "solver_order", 3);
    expect_key("DPMSolverMultistepScheduler", "lambda_min_clipped", -5.1);
    expect_key("PNDMScheduler", "skip_prk_steps", false);
    expect_key("PNDMScheduler", "prediction_type", "sample");
    EXPECT_NE(complaint({{"beta_end", 2}}).find("beta_start"), std::string::npos);
    const std::string unknown = complaint({{"_class_name", "FlowMatchHeunDiscreteScheduler"}});
    EXPECT_NE(unknown.find("_class_name"), std::string::npos) << unknown;
    EXPECT_NE(unknown.find("EulerDiscreteScheduler"), std::string::npos) << unknown;

    // This class is trained with the same noise as one that we can sample with, which is taken
    // instead.
    const auto relative = SchedulerConfig::from_json(
        {{"_class_name", "UniPCMultistepScheduler"}, {"solver_type", "bh2"}});
    EXPECT_EQ(relative.method, SamplerMethod::dpmpp_2m);

    SchedulerConfig zero_snr = SchedulerConfig::stable_diffusion("v_prediction");
    zero_snr.rescale_betas_zero_snr = true;
    EXPECT_THROW(zero_snr.with_sampler("pndm"), InputError);
    EXPECT_NO_THROW(zero_snr.with_sampler("euler"));
}

TEST(SchedulerConfig, TakesInfinitiesAsPythonWritesThem) {
    const testing::TemporaryFolder folder;
    const auto path = folder.path() / "scheduler_config.json";
    testing::write_file(
        path, R"({"lambda_min_clipped": -Infinity, "note": "NaN \" Infinity", "x": NaN})");
    EXPECT_EQ(NoiseSchedule::load(folder.path()).config().num_train_timesteps, 1000);
    EXPECT_EQ(Config::read(path).text("note", ""), "NaN \" Infinity");
    testing::write_file(path, R"({"beta_start": NaN})");
    EXPECT_THROW(NoiseSchedule::load(folder.path()), InputError);
    testing::write_file(path, R"({"beta_start": Infinite)");
    EXPECT_THROW(NoiseSchedule::load(folder.path()), InputError);
}

}  // namespace
}  // namespace item3d
