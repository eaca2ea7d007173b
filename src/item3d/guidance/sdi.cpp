#include "item3d/guidance/sdi.h"

#include "item3d/guidance/prediction.h"
#include "item3d/guidance/timestep_schedule.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t inversion_stride = 100;  ///< out of 1000 timesteps
constexpr double variance_part = 0.3;           ///< eta

/// Returns abar of a timestep. It may be negative, which means before the first timestep of the
/// training.
double alpha_of_level(const DiffusionModel& pipeline, std::int64_t level) {
    if (level < 0 && pipeline.schedule().config().set_alpha_to_one) return 1;
    return alpha_at(pipeline, std::max<std::int64_t>(level, 0));
}

}  // namespace

std::vector<std::int64_t> InversionDistillation::inversion_levels(std::int64_t t,
                                                                  double draw) const {
    const std::int64_t training_steps = pipeline_->schedule().alphas_cumprod().size(0);
    const std::int64_t stride = of_thousand(inversion_stride, training_steps);
    const std::int64_t offset = pipeline_->schedule().config().steps_offset;
    std::vector<std::int64_t> levels;
    for (std::int64_t level = offset - stride; level < t; level += stride)
        levels.push_back(level);
    const auto above = static_cast<std::int64_t>(static_cast<double>(stride) * draw);
    levels.push_back(std::min(t + above, training_steps - 1));
    return levels;
}

at::Tensor InversionDistillation::invert(const NoisedLatents& start, std::int64_t t,
                                         std::int64_t iteration) const {
    IterationDraws draws = iteration_draws(options_, iteration);
    const std::vector<std::int64_t> levels = inversion_levels(t, draws.uniform);
    at::Tensor latents = start.latents;
    for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
        const double from = alpha_of_level(*pipeline_, levels[i]);
        const double to = alpha_of_level(*pipeline_, levels[i + 1]);
        const NoisyInput input = noisy_input(start, latents, std::max<std::int64_t>(levels[i], 0));
        const at::Tensor noise = predict_guided(*pipeline_, input, target_text_, base_text_,
                                                2 - options_.guidance_scale);
        const double variance = (1 - from) / (1 - to) * (1 - to / from);
        latents = add_noise(clean_latents(latents, noise, from), noise, to) +
                  variance_part * std::sqrt(variance) * draws.normal_like(latents);
    }
    return latents;
}

GuidanceOutput InversionDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const std::int64_t t = start.timesteps[0].item<std::int64_t>();
    // The inversion ends slightly above t, but its result is used as z_t.
    const at::Tensor latents = invert(start, t, iteration);
    const at::Tensor noise = predict_guided(*pipeline_, noisy_input(start, latents, t),
                                            target_text_, base_text_, options_.guidance_scale);
    const at::Tensor direction =
        start.latents - clean_latents(latents, noise, alpha_at(*pipeline_, t));
    return finish_step(start, direction, direction, before);
}

}  // namespace item3d
