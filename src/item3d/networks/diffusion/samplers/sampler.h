// Samplers of diffusers, which turn noise into an image.
#pragma once

#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <vector>

namespace item3d {

/// One sampling run. Some samplers keep results of earlier steps, so each run needs its own object
/// and takes its steps in order.
///
///     auto sampler = make_sampler(schedule, {.steps = 30});
///     x = noise * sampler->initial_scale();
///     for (i = 0; i < sampler->steps(); ++i)
///         x = sampler->step(i, network(sampler->scale_input(i, x), sampler->timestep(i)), x, ...);
class Sampler {
  public:
    virtual ~Sampler() = default;
    /// Number of network evaluations; PNDM makes one more than was requested.
    int steps() const { return static_cast<int>(timesteps_.size()); }
    /// Timestep of step i, decreasing with i; Karras' spacing gives Euler fractional timesteps.
    double timestep(int i) const { return timesteps_.at(static_cast<std::size_t>(i)); }
    /// Standard deviation of the initial noise of a full run.
    virtual double initial_scale() const { return 1.0; }
    /// Returns an image with the noise level at which step i starts.
    virtual at::Tensor add_noise(int i, const at::Tensor& clean, const at::Tensor& noise) const = 0;
    /// Returns the network's input at step i.
    virtual at::Tensor scale_input(int i, const at::Tensor& sample) const {
        (void)i;
        return sample;
    }
    /// True if step i adds fresh noise.
    virtual bool draws_noise(int i) const {
        (void)i;
        return false;
    }
    /// Returns the sample after step i. model_output has the configured prediction_type.
    /// fresh_noise is standard normal, in the sample's shape, and is read only if draws_noise(i).
    virtual at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                            const at::Tensor& fresh_noise) = 0;

  protected:
    explicit Sampler(const NoiseSchedule& schedule) : schedule_(schedule) {}
    /// Returns abar at an integer timestep.
    double alpha_at(std::int64_t timestep) const;

    NoiseSchedule schedule_;
    std::vector<double> timesteps_;
};

struct SamplerOptions {
    int steps = 30;
    /// Number of steps to skip, for a run that begins with an image (add_noise at step 0).
    int skip = 0;
    /// Amount of fresh noise in each step, for DDIM only. 0 gives none, so that the run is
    /// deterministic; 1 gives as much as in DDPM.
    double eta = 0;
};

/// Makes a sampler of the schedule's method. options.steps must be in 1 to max_steps(), and
/// options.skip below options.steps.
std::unique_ptr<Sampler> make_sampler(const NoiseSchedule& schedule, const SamplerOptions& options);
int max_steps(const SchedulerConfig& config);

}  // namespace item3d
