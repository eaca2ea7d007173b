#include "item3d/guidance/dds.h"

#include "item3d/core/error.h"
#include "item3d/guidance/prediction.h"

namespace item3d {

DeltaDenoising::DeltaDenoising(std::shared_ptr<const DiffusionModel> pipeline,
                               const std::string& source_prompt, const std::string& target_prompt,
                               const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      source_text_(pipeline_->encode_text({source_prompt})),
      base_text_(encode_base(*pipeline_, options)) {}

GuidanceOutput DeltaDenoising::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    ITEM3D_CHECK(start.reference.defined(), "dds needs images of the unedited model");
    const double before = seconds_now();
    const at::NoGradGuard no_grad;
    NoisyInput unedited = noisy_input(start);
    unedited.latents =
        pipeline_->schedule().add_noise(start.reference, start.noise, start.timesteps);
    const float w = options_.guidance_scale;
    const at::Tensor direction =
        predict_guided(*pipeline_, noisy_input(start), target_text_, base_text_, w) -
        predict_guided(*pipeline_, unedited, source_text_, base_text_, w);
    return finish_step(start, direction, direction, before);
}

}  // namespace item3d
