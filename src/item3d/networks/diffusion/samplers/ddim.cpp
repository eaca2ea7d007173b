// DDIM (Song et al. 2021, eq. 12).
#include "item3d/networks/diffusion/samplers/ddim.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

class Ddim : public TimestepSampler {
  public:
    Ddim(const NoiseSchedule& schedule, const SamplerOptions& options)
        : TimestepSampler(schedule, options), eta_(options.eta) {}

    bool draws_noise(int) const override { return eta_ > 0; }

    at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                    const at::Tensor& fresh_noise) override {
        const SchedulerConfig& config = schedule_.config();
        const double alpha = alpha_at(whole_timestep(i));
        const double alpha_next = alpha_or_final(whole_timestep(i) - stride_);
        auto [clean, noise] = schedule_.interpret(model_output, sample, alpha);
        if (config.clip_sample)
            clean = clean.clamp(-config.clip_sample_range, config.clip_sample_range);

        const double variance = (1 - alpha_next) / (1 - alpha) * (1 - alpha / alpha_next);
        const double deviation = eta_ * std::sqrt(std::max(variance, 0.0));
        const double direction = std::sqrt(std::max(1 - alpha_next - deviation * deviation, 0.0));
        at::Tensor result = std::sqrt(alpha_next) * clean + direction * noise;
        if (eta_ > 0) {
            ITEM3D_CHECK(fresh_noise.defined(), "eta > 0 needs noise");
            result = result + deviation * fresh_noise;
        }
        return result;
    }

  private:
    double eta_;
};

}  // namespace

std::unique_ptr<Sampler> make_ddim(const NoiseSchedule& schedule, const SamplerOptions& options) {
    return std::make_unique<Ddim>(schedule, options);
}

}  // namespace item3d
