#include "item3d/guidance/sds.h"

#include "item3d/guidance/prediction.h"

namespace item3d {

GuidanceOutput ScoreDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    const at::Tensor direction = predict_guided(*pipeline_, noisy_input(start), target_text_,
                                                base_text_, options_.guidance_scale) -
                                 start.noise;
    return finish_step(start, direction, start.weight * direction, before);
}

}  // namespace item3d
