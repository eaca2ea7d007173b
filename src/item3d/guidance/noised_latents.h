// The first step of every method: renders encoded to latents, and noised at a random timestep.
#pragma once

#include "item3d/guidance/guidance.h"

#include <ATen/core/Generator.h>

namespace item3d {

struct NoisedLatents {
    at::Tensor own;                ///< [n, C, h, w] with graph to the images
    at::Tensor latents;            ///< [N, C, h, w] of all processes' images, no graph
    at::Tensor noise;              ///< [N, C, h, w] eps
    at::Tensor noisy;              ///< [N, C, h, w] z_t, no graph
    std::uint64_t noise_seed = 0;  ///< see GuidanceOutput
    at::Tensor timesteps;          ///< [N] int64
    at::Tensor alphas_cumprod;     ///< [N, 1, 1, 1] abar_t
    at::Tensor weight;             ///< [N, 1, 1, 1] omega(t)
    at::Tensor condition;          ///< for DiffusionModel::predict_noise; undefined: none
    at::Tensor reference;          ///< [N, C, h, w] of GuidanceInput::reference, no graph
    ProcessGroup processes;        ///< processes that share these rows
    std::int64_t first = 0;        ///< index of `own` among the N
    double seconds_encode = 0;
};

/// Encodes and noises the input. All rows of an iteration have the timestep of
/// scheduled_timestep(); it and the noise are deterministic in (seed, iteration).
NoisedLatents noise_latents(const DiffusionModel& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration);

/// Returns the latents of `start`, as constants, under `count` other noises each, with timesteps
/// spread evenly over the range of the options. Deterministic in (seed, iteration).
NoisedLatents renoise_latents(const DiffusionModel& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count);

/// Returns the concatenated rows of both; `own` is undefined.
NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second);
/// Returns rows [share.first, share.end()); `own` is undefined.
NoisedLatents narrow_rows(const NoisedLatents& all, const Share& share);

/// Random numbers of an iteration in addition to those of noise_latents().
struct IterationDraws {
    double uniform = 0;  ///< in [0, 1)
    at::Generator generator;
    /// Returns standard normal noise, different for each call.
    at::Tensor normal_like(const at::Tensor& latents);
};
IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration);

at::Tensor timestep_weight(Weighting weighting, const at::Tensor& alphas_cumprod);

/// Returns the output of a step: the gradient of this process's share, and the length of the
/// direction before weighting. unet_began: seconds_now() before the first prediction.
GuidanceOutput finish_step(const NoisedLatents& start, const at::Tensor& direction,
                           const at::Tensor& gradient, double unet_began);

double seconds_now();
float root_mean_square(const at::Tensor& tensor);

}  // namespace item3d
