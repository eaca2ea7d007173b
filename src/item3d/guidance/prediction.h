// Predictions of the U-Net for several prompts at once, and arithmetic of its noise (DDIM).
#pragma once

#include "item3d/guidance/noised_latents.h"
#include "item3d/processes/process_group.h"

namespace item3d {

/// Input of a prediction.
struct NoisyInput {
    at::Tensor latents;    ///< [N, C, h, w] z_t
    at::Tensor timesteps;  ///< [N] int64
    at::Tensor condition;  ///< for DiffusionModel::predict_noise; undefined: none
    ProcessGroup processes = {};
};
NoisyInput noisy_input(const NoisedLatents& start);
/// Returns an input for the same images at another noise level.
NoisyInput noisy_input(const NoisedLatents& start, const at::Tensor& latents,
                       std::int64_t timestep);

/// Returns the base of classifier-free guidance: the options' negative prompt, or no text.
TextEmbedding encode_base(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// Returns the negative prompt of nfsd and csd: the options' own, or default_negative_prompt().
TextEmbedding encode_negative(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// Returns eps(y) for each of these texts (one row each), from one call of the U-Net; constants.
/// The rows are shared out among the input's processes, each of which gets all results.
std::vector<at::Tensor> predict_each(const DiffusionModel& pipeline, const NoisyInput& input,
                                     const std::vector<TextEmbedding>& texts);

/// Returns eps^w(y) = eps(base) + w (eps(y) - eps(base)); two rows for each image.
at::Tensor predict_guided(const DiffusionModel& pipeline, const NoisyInput& input,
                          const TextEmbedding& text, const TextEmbedding& base,
                          double guidance_scale);

/// Returns the mean square error of eps(y), or of the velocity, in the prior's training objective.
/// A scalar, differentiable in the prediction.
at::Tensor denoising_loss(const DiffusionModel& pipeline, const at::Tensor& prediction,
                          const NoisedLatents& latents);

/// Returns abar_t.
double alpha_at(const DiffusionModel& pipeline, std::int64_t timestep);

/// Returns the clean latents of z_t for this noise: (z_t - sqrt(1 - a) eps) / sqrt(a).
at::Tensor clean_latents(const at::Tensor& noisy, const at::Tensor& noise, double alpha);

/// Returns sqrt(a) clean + sqrt(1 - a) noise.
at::Tensor add_noise(const at::Tensor& clean, const at::Tensor& noise, double alpha);

}  // namespace item3d
