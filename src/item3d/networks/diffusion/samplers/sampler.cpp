#include "item3d/networks/diffusion/samplers/sampler.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/samplers/methods.h"

#include <algorithm>
#include <cmath>

namespace item3d {

double Sampler::alpha_at(std::int64_t timestep) const {
    return schedule_.alphas_cumprod()[timestep].item<double>();
}

int most_steps(const SchedulerConfig& config) {
    // DPM-Solver++ divides the schedule into one part more.
    return config.num_train_timesteps - (config.method == SamplerMethod::dpmpp_2m ? 1 : 0);
}

std::unique_ptr<Sampler> make_sampler(const NoiseSchedule& schedule,
                                      const SamplerOptions& options) {
    const SchedulerConfig& config = schedule.config();
    ITEM3D_CHECK(options.steps >= 1 && options.steps <= most_steps(config),
                 "steps must be 1 to most_steps()");
    ITEM3D_CHECK(options.skip >= 0 && options.skip < options.steps, "no step would be left");
    ITEM3D_CHECK(options.eta == 0 || config.method == SamplerMethod::ddim, "eta is DDIM's");
    switch (config.method) {
        case SamplerMethod::ddim:
            return make_ddim(schedule, options);
        case SamplerMethod::ddpm:
            return make_ddpm(schedule, options);
        case SamplerMethod::euler:
            return make_euler(schedule, options);
        case SamplerMethod::dpmpp_2m:
            return make_dpmpp_2m(schedule, options);
        case SamplerMethod::pndm:
            return make_pndm(schedule, options);
    }
    ITEM3D_CHECK(false, "unknown method");
}

double round_to_even(double value) {
    return std::nearbyint(value);
}

std::vector<double> spaced_timesteps(const SchedulerConfig& config, int steps) {
    const int count = config.num_train_timesteps;
    const std::string spacing = config.spacing();
    std::vector<double> timesteps;
    for (int i = 0; i < steps; ++i) {
        const int from_end = steps - 1 - i;
        double timestep = 0;
        if (spacing == "linspace") {
            // In numpy's order: halves are rounded later, and must fall on the same side.
            if (steps > 1) timestep = from_end * (static_cast<double>(count - 1) / (steps - 1));
        } else if (spacing == "leading") {
            timestep = from_end * (count / steps) + config.steps_offset;
        } else {
            timestep = round_to_even(count - static_cast<double>(i) * count / steps) - 1;
        }
        timesteps.push_back(std::min<double>(timestep, count - 1));
    }
    return timesteps;
}

TimestepSampler::TimestepSampler(const NoiseSchedule& schedule, const SamplerOptions& options)
    : Sampler(schedule), stride_(schedule.config().num_train_timesteps / options.steps) {
    timesteps_ = spaced_timesteps(schedule.config(), options.steps);
    timesteps_.erase(timesteps_.begin(), timesteps_.begin() + options.skip);
    for (double& timestep : timesteps_)
        timestep = round_to_even(timestep);
}

double TimestepSampler::alpha_or_final(std::int64_t timestep) const {
    if (timestep >= 0) return alpha_at(timestep);
    return schedule_.config().set_alpha_to_one ? 1.0 : alpha_at(0);
}

torch::Tensor TimestepSampler::add_noise(int i, const torch::Tensor& clean,
                                         const torch::Tensor& noise) const {
    return schedule_.add_noise(clean, noise,
                               torch::full({clean.size(0)}, whole_timestep(i), clean.device()));
}

}  // namespace item3d
