// DPM-Solver++(2M) (Lu et al. 2022, algorithm 2): a multistep method of second order in
// lambda = log(sqrt(abar) / sqrt(1 - abar)) for the predicted image. The first and the last step
// are of first order.
#include "item3d/networks/diffusion/samplers/dpmpp_2m.h"

#include "item3d/networks/diffusion/samplers/sigmas.h"
#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

class Dpmpp2m : public Sampler {
  public:
    Dpmpp2m(const NoiseSchedule& schedule, const SamplerOptions& options) : Sampler(schedule) {
        SigmaSteps steps = choose_steps(options.steps);
        timesteps_.assign(steps.timesteps.begin() + options.skip, steps.timesteps.end());
        sigmas_.assign(steps.sigmas.begin() + options.skip, steps.sigmas.end());
    }

    at::Tensor add_noise(int i, const at::Tensor& clean, const at::Tensor& noise) const override {
        return signal(i) * clean + deviation(i) * noise;
    }

    at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                    const at::Tensor&) override {
        const at::Tensor clean =
            schedule_.interpret(model_output, sample, signal(i) * signal(i)).clean;
        at::Tensor estimate = clean;
        const double h = lambda(i + 1) - lambda(i);
        if (before_.defined() && i + 1 < steps()) {
            const double h_before = lambda(i) - lambda(i - 1);
            if (h_before > 0) estimate = clean + h / (2 * h_before) * (clean - before_);
        }
        before_ = clean;
        return deviation(i + 1) / deviation(i) * sample - signal(i + 1) * std::expm1(-h) * estimate;
    }

  private:
    SigmaSteps choose_steps(int count) const {
        const SchedulerConfig& config = schedule_.config();
        const std::vector<double> training = training_sigmas(schedule_);
        SigmaSteps steps;
        if (config.use_karras_sigmas) {
            steps = karras_steps(training, training.back(), training.front(), count);
            for (double& timestep : steps.timesteps)
                timestep = round_to_even(timestep);
            return steps;
        }
        // Spaces count + 1 timesteps, of which the last stands for the final image and is removed.
        // Trailing spacing has no timestep for the final image.
        const bool trailing = config.spacing() == "trailing";
        steps.timesteps = spaced_timesteps(config, trailing ? count : count + 1);
        steps.timesteps.resize(static_cast<std::size_t>(count));
        for (double& timestep : steps.timesteps) {
            timestep = round_to_even(timestep);
            steps.sigmas.push_back(interpolate_sigma(training, timestep));
        }
        steps.sigmas.push_back(0);
        return steps;
    }

    double sigma(int i) const { return sigmas_[static_cast<std::size_t>(i)]; }
    double signal(int i) const { return 1 / std::hypot(sigma(i), 1); }
    double deviation(int i) const { return sigma(i) * signal(i); }
    double lambda(int i) const { return -std::log(sigma(i)); }

    std::vector<double> sigmas_;
    at::Tensor before_;  ///< image predicted by the previous step
};

}  // namespace

std::unique_ptr<Sampler> make_dpmpp_2m(const NoiseSchedule& schedule,
                                       const SamplerOptions& options) {
    return std::make_unique<Dpmpp2m>(schedule, options);
}

}  // namespace item3d
