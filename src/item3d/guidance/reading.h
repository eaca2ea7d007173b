// The reading of images by a diffusion model. It tells where in an image the predictions for two
// sentences differ, and where the model attends to words.
#pragma once

#include "item3d/guidance/guidance.h"

#include <cstdint>
#include <string>
#include <utility>

namespace item3d {

struct ReadingOptions {
    double strength = 0.5;   ///< noise level, as a fraction of the training timesteps
    int noises = 8;          ///< number of noise draws, over which results are averaged
    std::uint64_t seed = 0;  ///< seed of the draws
};

/// Returns the difference of the predictions for two sentences, as in DiffEdit (Couairon et al.
/// 2022, "DiffEdit: Diffusion-based semantic image editing with mask guidance"). It is the absolute
/// difference of the predicted noise, averaged over draws and channels, [N, h, w] float32 on the
/// latents' grid. It is 0 where the sentences make no difference. input: only images and shape are
/// used.
at::Tensor prediction_difference(const DiffusionModel& model, const GuidanceInput& input,
                                 const TextEmbedding& source, const TextEmbedding& target,
                                 const ReadingOptions& options);

/// Normalises differences to [0, 1]: divides them by `outlier` times `mean`, and clips them.
/// Returns zeros if the mean is 0.
at::Tensor normalize_difference(const at::Tensor& difference, double mean, double outlier);

/// Returns the cross-attention of the model's U-Net, [N, S, h, w], averaged over draws
/// (DiffusionModel::cross_attention()).
at::Tensor mean_attention(const DiffusionModel& model, const GuidanceInput& input,
                          const TextEmbedding& text, const ReadingOptions& options);

}  // namespace item3d
