// What every method begins with: renders encoded, and noised at a random timestep.
#pragma once

#include "item3d/guidance/guidance.h"

#include <ATen/core/Generator.h>

namespace item3d {

struct NoisedLatents {
    torch::Tensor latents;         ///< [N, C, h, w] with graph to the images
    torch::Tensor noise;           ///< [N, C, h, w] eps
    torch::Tensor noisy;           ///< [N, C, h, w] z_t, no graph
    torch::Tensor timesteps;       ///< [N] int64
    torch::Tensor alphas_cumprod;  ///< [N, 1, 1, 1] abar_t
    torch::Tensor weight;          ///< [N, 1, 1, 1] omega(t)
    torch::Tensor condition;       ///< of Pipeline::predict_noise; undefined: none
    torch::Tensor reference;       ///< [N, C, h, w] of GuidanceInput::reference, no graph
    double seconds_encode = 0;
};

/// The same timestep for all rows of an iteration, as scheduled_timestep() has it; it and the noise
/// are drawn from (seed, iteration).
NoisedLatents noise_latents(const Pipeline& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration);

/// The latents of `start`, as constants, under `count` other noises for each; their timesteps are
/// spread evenly over the range of the options. Drawn from (seed, iteration) like the first.
NoisedLatents renoise_latents(const Pipeline& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count);

/// Rows of both, one after the other; neither has a graph then.
NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second);

/// Random numbers of an iteration beyond those of noise_latents().
struct IterationDraws {
    double uniform = 0;  ///< in [0, 1)
    at::Generator generator;
    /// Standard normal, another each time.
    torch::Tensor normal_like(const torch::Tensor& latents);
};
IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration);

torch::Tensor timestep_weight(Weighting weighting, const torch::Tensor& alphas_cumprod);

/// What a step returns: the gradient, and the direction before weighting for its length.
/// `unet_began`: seconds_now() before the first prediction.
GuidanceOutput finish_step(const NoisedLatents& start, const torch::Tensor& direction,
                           const torch::Tensor& gradient, double unet_began);

double seconds_now();
float root_mean_square(const torch::Tensor& tensor);

}  // namespace item3d
