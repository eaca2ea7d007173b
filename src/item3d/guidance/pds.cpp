#include "item3d/guidance/pds.h"

#include "item3d/core/error.h"
#include "item3d/guidance/prediction.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t grid_steps = 500;
constexpr double min_deviation = 1e-4;

}  // namespace

struct PosteriorDistillation::Step {
    std::int64_t timestep, previous;
    at::Tensor noise, previous_noise;
};

PosteriorDistillation::PosteriorDistillation(std::shared_ptr<const DiffusionModel> pipeline,
                                             const std::string& source_prompt,
                                             const std::string& target_prompt,
                                             const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      source_text_(pipeline_->encode_text({source_prompt})),
      base_text_(encode_base(*pipeline_, options)) {}

at::Tensor PosteriorDistillation::stochastic_latents(const NoisedLatents& start, const Step& step,
                                                     const at::Tensor& latents,
                                                     const TextEmbedding& text) const {
    const double alpha = alpha_at(*pipeline_, step.timestep);
    const double previous_alpha = alpha_at(*pipeline_, step.previous);
    // The coefficients are those of one training step, as in the published code, although t and t'
    // are farther apart.
    const double kept = alpha / alpha_at(*pipeline_, step.timestep - 1);
    const double beta = 1 - kept;

    const at::Tensor noisy = add_noise(latents, step.noise, alpha);
    const at::Tensor previous = add_noise(latents, step.previous_noise, previous_alpha);
    const at::Tensor noise = predict_guided(*pipeline_, noisy_input(start, noisy, step.timestep),
                                            text, base_text_, options_.guidance_scale);
    const at::Tensor mean =
        std::sqrt(previous_alpha) * beta / (1 - alpha) * clean_latents(noisy, noise, alpha) +
        std::sqrt(kept) * (1 - previous_alpha) / (1 - alpha) * noisy;
    const double deviation = std::sqrt((1 - previous_alpha) / (1 - alpha) * beta);
    return (previous - mean) / std::max(deviation, min_deviation);
}

GuidanceOutput PosteriorDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    ITEM3D_CHECK(start.reference.defined(), "pds needs images of the unedited model");
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const std::int64_t training_steps = pipeline_->schedule().alphas_cumprod().size(0);
    const std::int64_t stride = std::max<std::int64_t>(1, training_steps / grid_steps);
    const std::int64_t offset = pipeline_->schedule().config().steps_offset;
    const std::int64_t drawn = start.timesteps[0].item<std::int64_t>();
    Step step;
    step.timestep =
        std::min(std::max<std::int64_t>(1, drawn / stride) * stride + offset, training_steps - 1);
    step.previous = step.timestep - stride;
    step.noise = start.noise;
    step.previous_noise = iteration_draws(options_, iteration).normal_like(start.latents);

    const at::Tensor direction = stochastic_latents(start, step, start.latents, target_text_) -
                                 stochastic_latents(start, step, start.reference, source_text_);
    return finish_step(start, direction, direction, before);
}

}  // namespace item3d
