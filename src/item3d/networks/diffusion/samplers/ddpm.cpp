// DDPM (Ho et al. 2020, eq. 7), with the posterior's variance ("fixed_small").
#include "item3d/networks/diffusion/samplers/ddpm.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

class Ddpm : public TimestepSampler {
  public:
    Ddpm(const NoiseSchedule& schedule, const SamplerOptions& options)
        : TimestepSampler(schedule, options) {}

    bool draws_noise(int i) const override { return whole_timestep(i) > 0; }

    at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                    const at::Tensor& fresh_noise) override {
        const SchedulerConfig& config = schedule_.config();
        const double alpha = alpha_at(whole_timestep(i));
        const double alpha_next = i + 1 < steps() ? alpha_at(whole_timestep(i + 1)) : 1.0;
        const double ratio = alpha / alpha_next;
        at::Tensor clean = schedule_.interpret(model_output, sample, alpha).clean;
        if (config.clip_sample)
            clean = clean.clamp(-config.clip_sample_range, config.clip_sample_range);

        at::Tensor result = std::sqrt(alpha_next) * (1 - ratio) / (1 - alpha) * clean +
                            std::sqrt(ratio) * (1 - alpha_next) / (1 - alpha) * sample;
        if (draws_noise(i)) {
            ITEM3D_CHECK(fresh_noise.defined(), "DDPM needs noise");
            const double variance = (1 - alpha_next) / (1 - alpha) * (1 - ratio);
            result = result + std::sqrt(std::max(variance, 0.0)) * fresh_noise;
        }
        return result;
    }
};

}  // namespace

std::unique_ptr<Sampler> make_ddpm(const NoiseSchedule& schedule, const SamplerOptions& options) {
    return std::make_unique<Ddpm>(schedule, options);
}

}  // namespace item3d
