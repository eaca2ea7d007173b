// Asking the U-Net with several prompts at once, and walking along its noise (DDIM).
#pragma once

#include "item3d/guidance/noised_latents.h"
#include "item3d/processes/process_group.h"

namespace item3d {

/// What the U-Net is asked about.
struct NoisyInput {
    at::Tensor latents;    ///< [N, C, h, w] z_t
    at::Tensor timesteps;  ///< [N] int64
    at::Tensor condition;  ///< of DiffusionModel::predict_noise; undefined: none
    ProcessGroup processes = {};
};
NoisyInput noisy_input(const NoisedLatents& start);
/// The same pictures at another level of noise.
NoisyInput noisy_input(const NoisedLatents& start, const at::Tensor& latents,
                       std::int64_t timestep);

/// What classifier-free guidance starts from: the options' negative prompt, or no text.
TextEmbedding encode_base(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// What nfsd and csd push away from: the options' negative prompt, or default_negative_prompt().
TextEmbedding encode_negative(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// eps(y) for each of these texts (one row each), in one call of the U-Net; constants. The rows are
/// shared out among the input's processes, each of which gets all.
std::vector<at::Tensor> predict_each(const DiffusionModel& pipeline, const NoisyInput& input,
                                     const std::vector<TextEmbedding>& texts);

/// eps^w(y) = eps(base) + w (eps(y) - eps(base)), two rows an image.
at::Tensor predict_guided(const DiffusionModel& pipeline, const NoisyInput& input,
                          const TextEmbedding& text, const TextEmbedding& base,
                          double guidance_scale);

/// How far eps(y) is from the noise that is there: the mean square error that the model was trained
/// with, of eps or of the velocity. A scalar, differentiable in the prediction.
at::Tensor denoising_loss(const DiffusionModel& pipeline, const at::Tensor& prediction,
                          const NoisedLatents& latents);

/// abar_t, a number.
double alpha_at(const DiffusionModel& pipeline, std::int64_t timestep);

/// The clean latents that z_t is made of if its noise is this: (z_t - sqrt(1 - a) eps) / sqrt(a).
at::Tensor clean_latents(const at::Tensor& noisy, const at::Tensor& noise, double alpha);

/// sqrt(a) clean + sqrt(1 - a) noise.
at::Tensor add_noise(const at::Tensor& clean, const at::Tensor& noise, double alpha);

}  // namespace item3d
