#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace item3d {

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
            // Uses numpy's order of operations, because values that end in .5 are rounded later,
            // and must be rounded in the same direction.
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

at::Tensor TimestepSampler::add_noise(int i, const at::Tensor& clean,
                                      const at::Tensor& noise) const {
    return schedule_.add_noise(clean, noise,
                               at::full({clean.size(0)}, whole_timestep(i), clean.device()));
}

}  // namespace item3d
