#include "apps/parity/parity.h"
#include "item3d/networks/diffusion/samplers/sampler.h"

namespace item3d::parity {
namespace {

/// Compares noise and velocities at recorded training timesteps.
void check_schedule(Case& golden, const std::string& prefix, const NoiseSchedule& schedule) {
    golden.compare(prefix + "alphas_cumprod", schedule.alphas_cumprod(), within::scheduler_step);
    const at::Tensor sample = golden.input("sample"), noise = golden.input("noise");
    const std::int64_t last = schedule.config().num_train_timesteps - 1;
    std::vector<at::Tensor> noisy, mirrored, velocities;
    const at::Tensor timesteps = golden.input("noise_timesteps");
    for (std::int64_t i = 0; i < timesteps.size(0); ++i) {
        const at::Tensor rows = timesteps[i].expand({sample.size(0)});
        noisy.push_back(schedule.add_noise(sample, noise, rows));
        mirrored.push_back(schedule.add_noise(sample, noise, last - rows));
        velocities.push_back(schedule.get_velocity(sample, noise, rows));
    }
    golden.compare(prefix + "add_noise", at::stack(noisy), within::scheduler_step);
    golden.compare(prefix + "get_velocity", at::stack(velocities), within::scheduler_step);
    // DPMSolverMultistepScheduler counts from the wrong end until the number of steps is set.
    golden.compare(prefix + "add_noise_before_set_timesteps", at::stack(mirrored),
                   within::scheduler_step);
}

void check_run(Case& golden, const std::string& prefix, const NoiseSchedule& schedule,
               const SamplerOptions& options) {
    const at::Tensor sample = golden.input("sample"), noise = golden.input("noise");
    const at::Tensor outputs = golden.input("model_outputs"), draws = golden.input("step_noise");
    const auto sampler = make_sampler(schedule, options);
    std::vector<double> timesteps;
    std::vector<at::Tensor> scaled, trajectory, noisy;
    at::Tensor current = sample * sampler->initial_scale();
    std::int64_t drawn = 0;
    for (int i = 0; i < sampler->steps(); ++i) {
        timesteps.push_back(sampler->timestep(i));
        scaled.push_back(sampler->scale_input(i, current));
        const at::Tensor fresh = sampler->draws_noise(i) ? draws[drawn++] : at::Tensor();
        current = sampler->step(i, outputs[i], current, fresh);
        trajectory.push_back(current);
    }
    // Timesteps between the training timesteps are computed from float32 logarithms.
    const bool whole = schedule.config().method != SamplerMethod::euler;
    golden.compare(prefix + "timesteps", at::tensor(timesteps),
                   whole ? within::exact : within::scheduler_step);
    golden.compare(prefix + "init_noise_sigma", at::tensor({sampler->initial_scale()}),
                   within::scheduler_step);
    golden.compare(prefix + "scaled_input", at::stack(scaled), within::scheduler_step);
    golden.compare(prefix + "prev_sample", at::stack(trajectory), within::scheduler_step);
    for (const int i : {0, 4, 9})
        if (i < sampler->steps()) noisy.push_back(sampler->add_noise(i, sample, noise));
    golden.compare(prefix + "add_noise_schedule", at::stack(noisy), within::scheduler_step);
    if (schedule.config().goes_by_sigma()) {
        // The output is add_noise of pure noise. The samples of DPM-Solver++ have a variance of
        // one.
        std::vector<double> sigmas;
        const at::Tensor zero = at::zeros({1}), one = at::ones({1});
        for (int i = 0; i < sampler->steps(); ++i)
            sigmas.push_back(sampler->add_noise(i, zero, one).item<double>() /
                             sampler->add_noise(i, one, zero).item<double>());
        sigmas.push_back(0);
        golden.compare(prefix + "sigmas", at::tensor(sigmas), within::scheduler_step);
    }
}

}  // namespace

void check_schedulers(Case& golden) {
    const Config meta = golden.meta();
    const int steps = meta.size("steps", 10);
    for (const std::string& config : meta.texts("configs", {})) {
        for (const std::string& kind : meta.texts("kinds", {})) {
            const std::string prefix = config + "." + kind + ".";
            const NoiseSchedule schedule = NoiseSchedule::load(golden.folder() / config / kind);
            check_schedule(golden, prefix, schedule);
            check_run(golden, prefix, schedule,
                      {.steps = steps, .eta = kind == "ddim_eta" ? 0.6 : 0.0});
        }
    }
}

}  // namespace item3d::parity
