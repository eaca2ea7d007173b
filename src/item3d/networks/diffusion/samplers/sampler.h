// From noise to a picture: the samplers of diffusers.
#pragma once

#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <vector>

namespace item3d {

/// One sampling run. Some samplers remember earlier steps, so that a run needs an object of its own
/// and takes its steps in order.
///
///     auto sampler = make_sampler(schedule, {.steps = 30});
///     x = noise * sampler->initial_scale();
///     for (i = 0; i < sampler->steps(); ++i)
///         x = sampler->step(i, network(sampler->scale_input(i, x), sampler->timestep(i)), x, ...);
class Sampler {
  public:
    virtual ~Sampler() = default;
    /// How often the network is asked; PNDM asks once more than it was told.
    int steps() const { return static_cast<int>(timesteps_.size()); }
    /// Decreasing with i; Karras' spacing puts Euler between the timesteps of training.
    double timestep(int i) const { return timesteps_.at(static_cast<std::size_t>(i)); }
    /// The standard deviation of the noise that a whole run starts from.
    virtual double initial_scale() const { return 1.0; }
    /// A picture with as much noise as step i starts from.
    virtual at::Tensor add_noise(int i, const at::Tensor& clean, const at::Tensor& noise) const = 0;
    /// What the network reads at step i.
    virtual at::Tensor scale_input(int i, const at::Tensor& sample) const {
        (void)i;
        return sample;
    }
    /// True where step i adds noise of its own.
    virtual bool draws_noise(int i) const {
        (void)i;
        return false;
    }
    /// The sample after step i. model_output: of the configured prediction_type. fresh_noise:
    /// standard normal, of the sample's shape; read where draws_noise(i).
    virtual at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                            const at::Tensor& fresh_noise) = 0;

  protected:
    explicit Sampler(const NoiseSchedule& schedule) : schedule_(schedule) {}
    /// abar of an integer timestep.
    double alpha_at(std::int64_t timestep) const;

    NoiseSchedule schedule_;
    std::vector<double> timesteps_;
};

struct SamplerOptions {
    int steps = 30;
    int skip = 0;  ///< of the steps, for a run that begins with a picture (add_noise at step 0)
    /// DDIM alone. 0: deterministic; 1: as much fresh noise in each step as DDPM.
    double eta = 0;
};

/// A run by the schedule's own method. steps: 1 to most_steps(), skip: below steps.
std::unique_ptr<Sampler> make_sampler(const NoiseSchedule& schedule, const SamplerOptions& options);
int most_steps(const SchedulerConfig& config);

}  // namespace item3d
