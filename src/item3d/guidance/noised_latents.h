// What every method begins with: renders encoded, and noised at a random timestep.
#pragma once

#include "item3d/guidance/guidance.h"

#include <ATen/core/Generator.h>

namespace item3d {

struct NoisedLatents {
    at::Tensor own;             ///< [n, C, h, w] with graph to the images
    at::Tensor latents;         ///< [N, C, h, w] of all processes' images, no graph
    at::Tensor noise;           ///< [N, C, h, w] eps
    at::Tensor noisy;           ///< [N, C, h, w] z_t, no graph
    at::Tensor timesteps;       ///< [N] int64
    at::Tensor alphas_cumprod;  ///< [N, 1, 1, 1] abar_t
    at::Tensor weight;          ///< [N, 1, 1, 1] omega(t)
    at::Tensor condition;       ///< of DiffusionModel::predict_noise; undefined: none
    at::Tensor reference;       ///< [N, C, h, w] of GuidanceInput::reference, no graph
    ProcessGroup processes;     ///< that predict of these together
    std::int64_t first = 0;     ///< place of `own` among the N
    double seconds_encode = 0;
};

/// The same timestep for all rows of an iteration, as scheduled_timestep() has it; it and the noise
/// are drawn from (seed, iteration).
NoisedLatents noise_latents(const DiffusionModel& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration);

/// The latents of `start`, as constants, under `count` other noises for each; their timesteps are
/// spread evenly over the range of the options. Drawn from (seed, iteration) like the first.
NoisedLatents renoise_latents(const DiffusionModel& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count);

/// Rows of both, one after the other; `own` is of neither.
NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second);
/// Rows [share.first, share.end()), without `own`.
NoisedLatents narrow_rows(const NoisedLatents& all, const Share& share);

/// Random numbers of an iteration beyond those of noise_latents().
struct IterationDraws {
    double uniform = 0;  ///< in [0, 1)
    at::Generator generator;
    /// Standard normal, another each time.
    at::Tensor normal_like(const at::Tensor& latents);
};
IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration);

at::Tensor timestep_weight(Weighting weighting, const at::Tensor& alphas_cumprod);

/// What a step returns: the gradient of what is this process's own, and the direction before
/// weighting for its length.
/// `unet_began`: seconds_now() before the first prediction.
GuidanceOutput finish_step(const NoisedLatents& start, const at::Tensor& direction,
                           const at::Tensor& gradient, double unet_began);

double seconds_now();
float root_mean_square(const at::Tensor& tensor);

}  // namespace item3d
