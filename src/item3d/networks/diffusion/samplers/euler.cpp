// Euler's method for dx / dsigma = (x - x_0) / sigma (Karras et al. 2022, algorithm 1). Samples are
// x_0 + sigma eps, so the network's input must be scaled.
#include "item3d/networks/diffusion/samplers/euler.h"

#include "item3d/networks/diffusion/samplers/sigmas.h"
#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <cmath>

namespace item3d {
namespace {

class Euler : public Sampler {
  public:
    Euler(const NoiseSchedule& schedule, const SamplerOptions& options) : Sampler(schedule) {
        const SchedulerConfig& config = schedule.config();
        const std::vector<double> training = training_sigmas(schedule);
        SigmaSteps steps;
        steps.timesteps = spaced_timesteps(config, options.steps);
        for (const double timestep : steps.timesteps)
            steps.sigmas.push_back(interpolate_sigma(training, timestep));
        if (config.use_karras_sigmas)
            steps =
                karras_steps(training, steps.sigmas.front(), steps.sigmas.back(), options.steps);
        else
            steps.sigmas.push_back(0);
        timesteps_.assign(steps.timesteps.begin() + options.skip, steps.timesteps.end());
        sigmas_.assign(steps.sigmas.begin() + options.skip, steps.sigmas.end());
    }

    double initial_scale() const override {
        // The first sample contains signal (variance 1) besides the noise if the spacing is
        // leading. Otherwise it is noise alone.
        return schedule_.config().spacing() == "leading" ? std::hypot(sigmas_[0], 1) : sigmas_[0];
    }
    at::Tensor add_noise(int i, const at::Tensor& clean, const at::Tensor& noise) const override {
        return clean + sigma(i) * noise;
    }
    at::Tensor scale_input(int i, const at::Tensor& sample) const override {
        return sample / std::hypot(sigma(i), 1);
    }
    at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                    const at::Tensor&) override {
        const double alpha = 1 / (1 + sigma(i) * sigma(i));
        const at::Tensor clean =
            schedule_.interpret(model_output, scale_input(i, sample), alpha).clean;
        return sample + (sample - clean) / sigma(i) * (sigma(i + 1) - sigma(i));
    }

  private:
    double sigma(int i) const { return sigmas_[static_cast<std::size_t>(i)]; }

    std::vector<double> sigmas_;
};

}  // namespace

std::unique_ptr<Sampler> make_euler(const NoiseSchedule& schedule, const SamplerOptions& options) {
    return std::make_unique<Euler>(schedule, options);
}

}  // namespace item3d
