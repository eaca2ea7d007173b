#include "item3d/guidance/ism.h"

#include "item3d/guidance/prediction.h"
#include "item3d/guidance/timestep_schedule.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr double warm_up_part = 0.3;  ///< share of the edit: 1500 of the published 5000 iterations
/// Delta, as a share of all timesteps.
constexpr double first_interval = 0.1, last_interval = 0.08;
constexpr std::int64_t path_stride = 200;  ///< out of 1000 timesteps
constexpr std::int64_t path_steps = 5;
constexpr double channel_offset = 0.1;  ///< deviation of the random offset of each noise channel

GuidanceOptions warmed_up(GuidanceOptions options, double warm_up) {
    const auto middle = 0.5 * (options.min_timestep + options.max_timestep);
    options.max_timestep = static_cast<float>(middle + (options.max_timestep - middle) * warm_up);
    return options;
}

}  // namespace

GuidanceOutput IntervalScore::step(const GuidanceInput& input, std::int64_t iteration) {
    const double warm_up = std::max(0.0, 1 - progress_of(options_, iteration) / warm_up_part);
    const NoisedLatents start =
        noise_latents(*pipeline_, input, warmed_up(options_, warm_up), iteration);
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const std::int64_t training_steps = pipeline_->schedule().alphas_cumprod().size(0);
    const double interval = last_interval + (first_interval - last_interval) * warm_up;
    const auto delta =
        static_cast<std::int64_t>(std::ceil(interval * static_cast<double>(training_steps)));
    const std::int64_t t = start.timesteps[0].item<std::int64_t>();
    const std::int64_t s = std::max<std::int64_t>(t - delta, 0);
    const std::int64_t stride = of_thousand(path_stride, training_steps);
    const std::int64_t first = std::max<std::int64_t>(s - path_steps * stride, 0);

    const at::Tensor offsets = iteration_draws(options_, iteration)
                                   .normal_like(start.latents.slice(2, 0, 1).slice(3, 0, 1));
    at::Tensor latents = add_noise(start.latents, start.noise + channel_offset * offsets,
                                   alpha_at(*pipeline_, first));
    const auto predict_base = [&](std::int64_t timestep) {
        return predict_each(*pipeline_, noisy_input(start, latents, timestep), {base_text_})[0];
    };
    const auto step_up = [&](const at::Tensor& noise, std::int64_t from, std::int64_t to) {
        return add_noise(clean_latents(latents, noise, alpha_at(*pipeline_, from)), noise,
                         alpha_at(*pipeline_, to));
    };
    for (std::int64_t level = first; level < s;) {
        const std::int64_t next = std::min(level + stride, s);
        latents = step_up(predict_base(level), level, next);
        level = next;
    }
    const at::Tensor lower = predict_base(s);
    latents = step_up(lower, s, t);
    const at::Tensor direction = predict_guided(*pipeline_, noisy_input(start, latents, t),
                                                target_text_, base_text_, options_.guidance_scale) -
                                 lower;
    const double alpha = alpha_at(*pipeline_, t);
    return finish_step(start, direction, std::sqrt((1 - alpha) / alpha) * direction, before);
}

}  // namespace item3d
