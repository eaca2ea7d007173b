#include "item3d/guidance/sds.h"

#include "item3d/guidance/prediction.h"

namespace item3d {

ScoreDistillation::ScoreDistillation(std::shared_ptr<const Pipeline> pipeline,
                                     const std::string& target_prompt,
                                     const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      base_text_(encode_base(*pipeline_, options)) {}

GuidanceOutput ScoreDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const torch::NoGradGuard no_grad;
    const torch::Tensor direction = predict_guided(*pipeline_, noisy_input(start), target_text_,
                                                   base_text_, options_.guidance_scale) -
                                    start.noise;
    return finish_step(start, direction, start.weight * direction, before);
}

}  // namespace item3d
