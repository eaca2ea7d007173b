// The methods behind make_sampler, a file for each, and what they share.
#pragma once

#include "item3d/networks/diffusion/samplers/sampler.h"

namespace item3d {

std::unique_ptr<Sampler> make_ddim(const NoiseSchedule& schedule, const SamplerOptions& options);
std::unique_ptr<Sampler> make_ddpm(const NoiseSchedule& schedule, const SamplerOptions& options);
std::unique_ptr<Sampler> make_euler(const NoiseSchedule& schedule, const SamplerOptions& options);
std::unique_ptr<Sampler> make_dpmpp_2m(const NoiseSchedule& schedule,
                                       const SamplerOptions& options);
std::unique_ptr<Sampler> make_pndm(const NoiseSchedule& schedule, const SamplerOptions& options);

/// The `steps` timesteps of a run from noisy to clean, not rounded (table 2 of Lin et al. 2024).
std::vector<double> spaced_timesteps(const SchedulerConfig& config, int steps);
/// Halves to even, as numpy rounds.
double round_to_even(double value);

/// A sampler whose samples are x_t at integer timesteps, `stride` of them apart.
class TimestepSampler : public Sampler {
  public:
    torch::Tensor add_noise(int i, const torch::Tensor& clean,
                            const torch::Tensor& noise) const override;

  protected:
    TimestepSampler(const NoiseSchedule& schedule, const SamplerOptions& options);
    std::int64_t whole_timestep(int i) const { return static_cast<std::int64_t>(timestep(i)); }
    /// abar, or what set_alpha_to_one says below the first timestep.
    double alpha_or_final(std::int64_t timestep) const;

    std::int64_t stride_;
};

/// The noise levels of a run and the timesteps that stand for them.
struct SigmaSteps {
    std::vector<double> timesteps;  ///< [n]
    std::vector<double> sigmas;     ///< [n + 1], the last one 0
};

/// sqrt((1 - abar) / abar) of each timestep of training, increasing.
std::vector<double> training_sigmas(const NoiseSchedule& schedule);
/// `sigmas` (of training) at a timestep between two of them.
double interpolate_sigma(const std::vector<double>& sigmas, double timestep);
/// n levels from `largest` to `smallest`, dense near the small ones (Karras et al. 2022, rho 7),
/// and their timesteps, linear in log sigma between those of training.
SigmaSteps karras_steps(const std::vector<double>& sigmas, double largest, double smallest, int n);

}  // namespace item3d
