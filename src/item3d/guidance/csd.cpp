#include "item3d/guidance/csd.h"

#include "item3d/guidance/prediction.h"
#include "item3d/guidance/timestep_schedule.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr double target_weight = 1.05;
constexpr double first_part = 0.25;  ///< share of the edit: 500 of DreamMat's 2000 iterations

GuidanceOptions narrowed(GuidanceOptions options, double progress) {
    const float low = progress < first_part ? 0.2f : 0.02f;
    const float high = progress < first_part ? 0.8f : 0.5f;
    options.min_timestep = std::clamp(options.min_timestep, low, high);
    options.max_timestep = std::clamp(options.max_timestep, low, high);
    return options;
}

}  // namespace

GuidanceOutput ClassifierScore::step(const GuidanceInput& input, std::int64_t iteration) {
    const double progress = progress_of(options_, iteration);
    const NoisedLatents start =
        noise_latents(*pipeline_, input, narrowed(options_, progress), iteration);
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const auto eps =
        predict_each(*pipeline_, noisy_input(start), {target_text_, negative_text_, no_text_});
    const at::Tensor direction =
        target_weight * eps[0] + (-1 + 0.5 * progress) * eps[1] - 0.5 * progress * eps[2];
    return finish_step(start, direction, start.weight * direction, before);
}

}  // namespace item3d
