// PNDM (Liu et al. 2022) without Runge-Kutta steps. The noise is extrapolated from up to four
// predictions (Adams-Bashforth). The first step is done twice; the second time it uses the mean of
// the noise at its two ends.
#include "item3d/networks/diffusion/samplers/pndm.h"

#include "item3d/networks/diffusion/samplers/timesteps.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

class Pndm : public TimestepSampler {
  public:
    Pndm(const NoiseSchedule& schedule, const SamplerOptions& options)
        : TimestepSampler(schedule, options) {
        if (timesteps_.size() > 1) timesteps_.insert(timesteps_.begin() + 1, timesteps_[1]);
    }

    at::Tensor step(int i, const at::Tensor& model_output, const at::Tensor& sample,
                    const at::Tensor&) override {
        if (i == 1) {  // repeats the step from the first timestep
            const std::int64_t first = std::min<std::int64_t>(
                whole_timestep(i) + stride_, schedule_.config().num_train_timesteps - 1);
            return move(start_, (model_output + outputs_.back()) / 2, first, whole_timestep(i));
        }
        if (i == 0) start_ = sample;
        if (outputs_.size() == 4) outputs_.erase(outputs_.begin());
        outputs_.push_back(model_output);
        return move(sample, extrapolate(), whole_timestep(i), whole_timestep(i) - stride_);
    }

  private:
    at::Tensor extrapolate() const {
        const std::vector<at::Tensor> e(outputs_.rbegin(), outputs_.rend());
        switch (e.size()) {
            case 1:
                return e[0];
            case 2:
                return (3 * e[0] - e[1]) / 2;
            case 3:
                return (23 * e[0] - 16 * e[1] + 5 * e[2]) / 12;
            default:
                return (55 * e[0] - 59 * e[1] + 37 * e[2] - 9 * e[3]) / 24;
        }
    }

    /// Performs DDIM's step, eq. 9 of the paper.
    at::Tensor move(const at::Tensor& sample, const at::Tensor& model_output, std::int64_t from,
                    std::int64_t to) const {
        const double alpha_next = alpha_or_final(to);
        const auto [clean, noise] = schedule_.interpret(model_output, sample, alpha_at(from));
        return std::sqrt(alpha_next) * clean + std::sqrt(1 - alpha_next) * noise;
    }

    at::Tensor start_;
    std::vector<at::Tensor> outputs_;  ///< the last four outputs, at different timesteps
};

}  // namespace

std::unique_ptr<Sampler> make_pndm(const NoiseSchedule& schedule, const SamplerOptions& options) {
    return std::make_unique<Pndm>(schedule, options);
}

}  // namespace item3d
