// Predictions of the U-Net for several prompts at once, and the arithmetic of noise (DDIM).
// Symbols: guidance.h.
#pragma once

#include "item3d/guidance/noised_latents.h"
#include "item3d/processes/process_group.h"

namespace item3d {

/// Input of a prediction.
struct NoisyInput {
    at::Tensor latents;    ///< [N, C, h, w] z_t
    at::Tensor timesteps;  ///< [N] int64
    at::Tensor condition;  ///< for DiffusionModel::predict_noise(); may be undefined
    ProcessGroup processes = {};
};
NoisyInput noisy_input(const NoisedLatents& start);
/// Returns an input for the same images at another noise level. latents: the noisy latents of that
/// level.
NoisyInput noisy_input(const NoisedLatents& start, const at::Tensor& latents,
                       std::int64_t timestep);

/// Returns the base of classifier-free guidance: the negative prompt of the options, or no text if
/// that is empty.
TextEmbedding encode_base(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// Returns the negative prompt of nfsd and csd: that of the options, or default_negative_prompt()
/// if that is empty.
TextEmbedding encode_negative(const DiffusionModel& pipeline, const GuidanceOptions& options);

/// Returns eps(y), as constants, for each of the texts, which have one row each. The U-Net is
/// called once. The rows are shared out among the input's processes, each of which gets all
/// results.
std::vector<at::Tensor> predict_each(const DiffusionModel& pipeline, const NoisyInput& input,
                                     const std::vector<TextEmbedding>& texts);

/// Returns eps^w(y) = eps(base) + w (eps(y) - eps(base)), where w is guidance_scale. Takes two rows
/// of the U-Net for each image.
at::Tensor predict_guided(const DiffusionModel& pipeline, const NoisyInput& input,
                          const TextEmbedding& text, const TextEmbedding& base,
                          double guidance_scale);

/// Returns the mean square error of a prediction as in the prior's training, which is the error of
/// the noise or of the velocity. prediction: eps(y). The result is a scalar and is differentiable
/// with respect to the prediction.
at::Tensor denoising_loss(const DiffusionModel& pipeline, const at::Tensor& prediction,
                          const NoisedLatents& latents);

/// Returns abar_t.
double alpha_at(const DiffusionModel& pipeline, std::int64_t timestep);

/// Returns the clean latents (z_t - sqrt(1 - alpha) eps) / sqrt(alpha), where `noisy` is z_t and
/// `noise` is eps.
at::Tensor clean_latents(const at::Tensor& noisy, const at::Tensor& noise, double alpha);

/// Returns sqrt(alpha) clean + sqrt(1 - alpha) noise.
at::Tensor add_noise(const at::Tensor& clean, const at::Tensor& noise, double alpha);

}  // namespace item3d
