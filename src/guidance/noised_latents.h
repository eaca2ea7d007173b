// What every method begins with: renders encoded, and noised at a random timestep.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

struct NoisedLatents {
    torch::Tensor latents;         ///< [N, C, h, w] with graph to the images
    torch::Tensor noise;           ///< [N, C, h, w] eps
    torch::Tensor noisy;           ///< [N, C, h, w] z_t, no graph
    torch::Tensor timesteps;       ///< [N] int64
    torch::Tensor alphas_cumprod;  ///< [N, 1, 1, 1] abar_t
    torch::Tensor weight;          ///< [N, 1, 1, 1] omega(t)
    torch::Tensor condition;       ///< of Pipeline::predict_noise; undefined: none
    double seconds_encode = 0;
};

/// The same timestep for all rows of an iteration, drawn with the noise from (seed, iteration).
NoisedLatents noise_latents(const Pipeline& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration);

/// The latents of `start`, as constants, under `count` other noises for each; their timesteps are
/// spread evenly over the range of the options. Drawn from (seed, iteration) like the first.
NoisedLatents renoise_latents(const Pipeline& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count);

/// Rows of both, one after the other; neither has a graph then.
NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second);

torch::Tensor timestep_weight(Weighting weighting, const torch::Tensor& alphas_cumprod);

/// The rows twice, one after the other; an undefined tensor stays undefined.
torch::Tensor twice(const torch::Tensor& rows);

double seconds_now();
float root_mean_square(const torch::Tensor& tensor);

}  // namespace item3d
