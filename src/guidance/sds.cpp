#include "item3d/guidance/sds.h"

#include "item3d/guidance/noised_latents.h"

namespace item3d {

ScoreDistillation::ScoreDistillation(std::shared_ptr<const Pipeline> pipeline,
                                     const std::string& target_prompt,
                                     const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      no_text_(options.negative_prompt.empty()
                   ? pipeline_->encode_no_text()
                   : pipeline_->encode_text({options.negative_prompt})) {}

GuidanceOutput ScoreDistillation::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const std::int64_t rows = start.noisy.size(0);

    const torch::NoGradGuard no_grad;
    const double before = seconds_now();
    const TextEmbedding text =
        TextEmbedding::join(target_text_.expand(rows), no_text_.expand(rows));
    const auto predictions = pipeline_
                                 ->predict_noise(twice(start.noisy), twice(start.timesteps), text,
                                                 twice(start.condition))
                                 .chunk(2);
    const torch::Tensor guided =
        predictions[1] + options_.guidance_scale * (predictions[0] - predictions[1]);
    const torch::Tensor direction = guided - start.noise;

    GuidanceOutput output;
    output.latents = start.latents;
    output.latents_gradient = start.weight * direction;
    output.direction_length = root_mean_square(direction);
    output.seconds_encode = start.seconds_encode;
    output.seconds_unet = seconds_now() - before;
    return output;
}

}  // namespace item3d
