#include "item3d/guidance/nfsd.h"

#include "item3d/guidance/prediction.h"
#include "item3d/guidance/timestep_schedule.h"

namespace item3d {
namespace {

/// Timestep, of 1000. At lower timesteps, eps(empty) is mostly detail.
constexpr std::int64_t little_noise = 200;

}  // namespace

GuidanceOutput NoiseFreeDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const auto eps =
        predict_each(*pipeline_, noisy_input(start), {target_text_, no_text_, negative_text_});
    const std::int64_t training_steps = pipeline_->schedule().alphas_cumprod().size(0);
    const bool is_clean =
        start.timesteps[0].item<std::int64_t>() < of_thousand(little_noise, training_steps);
    const at::Tensor to_real = is_clean ? eps[1] : eps[1] - eps[2];
    const at::Tensor direction = to_real + options_.guidance_scale * (eps[0] - eps[1]);
    return finish_step(start, direction, start.weight * direction, before);
}

}  // namespace item3d
