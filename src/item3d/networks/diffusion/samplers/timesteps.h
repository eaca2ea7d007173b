// Timesteps of a sampling run.
#pragma once

#include "item3d/networks/diffusion/samplers/sampler.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Returns the `steps` timesteps of a run from noisy to clean, not rounded (table 2 of Lin et al.
/// 2024).
std::vector<double> spaced_timesteps(const SchedulerConfig& config, int steps);
/// Rounds halves to even, as numpy does.
double round_to_even(double value);

/// Base class of samplers whose samples are x_t at integer timesteps, `stride_` apart.
class TimestepSampler : public Sampler {
  public:
    at::Tensor add_noise(int i, const at::Tensor& clean, const at::Tensor& noise) const override;

  protected:
    TimestepSampler(const NoiseSchedule& schedule, const SamplerOptions& options);
    std::int64_t whole_timestep(int i) const { return static_cast<std::int64_t>(timestep(i)); }
    /// Returns abar at a timestep. Below the first timestep, returns the value that
    /// set_alpha_to_one selects.
    double alpha_or_final(std::int64_t timestep) const;

    std::int64_t stride_;
};

}  // namespace item3d
