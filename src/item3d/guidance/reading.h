// What a diffusion model reads in pictures: where two sentences make it see another thing, and
// where it looks for words.
#pragma once

#include "item3d/guidance/guidance.h"

#include <cstdint>
#include <string>
#include <utility>

namespace item3d {

struct ReadingOptions {
    double strength = 0.5;   ///< level of the noise, as a fraction of the training timesteps
    int noises = 8;          ///< draws that are averaged over
    std::uint64_t seed = 0;  ///< of the draws
};

/// How far the predictions under two sentences are apart, DiffEdit's way (Couairon et al. 2022,
/// "DiffEdit: Diffusion-based semantic image editing with mask guidance"): the absolute difference
/// of the predicted noise, averaged over draws and channels. `input`: images and their shape.
/// Returns [N, h, w] float32 on the latents' grid, 0 where the sentences make no difference.
at::Tensor prediction_difference(const DiffusionModel& model, const GuidanceInput& input,
                                 const TextEmbedding& source, const TextEmbedding& target,
                                 const ReadingOptions& options);

/// Differences as [0, 1]: divided by `outlier` times `mean`, and clipped there. 0 where the mean
/// is.
at::Tensor normalize_difference(const at::Tensor& difference, double mean, double outlier);

/// Cross-attention of the model's U-Net, averaged over draws: [N, S, h, w], see
/// DiffusionModel::cross_attention().
at::Tensor mean_attention(const DiffusionModel& model, const GuidanceInput& input,
                          const TextEmbedding& text, const ReadingOptions& options);

}  // namespace item3d
