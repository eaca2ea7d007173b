// The first step of every method: renders are encoded to latents, and noised at the iteration's
// timestep. Symbols: guidance.h.
#pragma once

#include "item3d/guidance/guidance.h"

#include <ATen/core/Generator.h>

namespace item3d {

struct NoisedLatents {
    at::Tensor own;                ///< [n, C, h, w] latents of this process, with graph
    at::Tensor latents;            ///< [N, C, h, w] z of all processes, before noise, detached
    at::Tensor noise;              ///< [N, C, h, w] eps
    at::Tensor noisy;              ///< [N, C, h, w] z_t, after noise, detached
    std::uint64_t noise_seed = 0;  ///< as GuidanceOutput::noise_seed
    at::Tensor timesteps;          ///< [N] int64
    at::Tensor alphas_cumprod;     ///< [N, 1, 1, 1] abar_t
    at::Tensor weight;             ///< [N, 1, 1, 1] omega(t)
    at::Tensor condition;          ///< for DiffusionModel::predict_noise(); may be undefined
    at::Tensor reference;          ///< [N, C, h, w] latents of GuidanceInput::reference
    ProcessGroup processes;        ///< processes that share these rows
    std::int64_t first = 0;        ///< index of the first row of `own` among the N rows
    double seconds_encode = 0;
};

/// Encodes and noises the input. All rows of an iteration have one timestep, scheduled_timestep().
/// The timestep and the noise are deterministic in (seed, iteration).
NoisedLatents noise_latents(const DiffusionModel& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration);

/// Returns each latent of `start` under `count` other noises, as constants. The timesteps are
/// spread evenly over the range of the options. The result is deterministic in (seed, iteration).
NoisedLatents renoise_latents(const DiffusionModel& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count);

/// Returns the rows of both, concatenated; `own` of the result is undefined.
NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second);
/// Returns the rows [share.first, share.end()); `own` of the result is undefined.
NoisedLatents narrow_rows(const NoisedLatents& all, const Share& share);

/// Random numbers of an iteration in addition to those of noise_latents().
struct IterationDraws {
    double uniform = 0;  ///< in [0, 1)
    at::Generator generator;
    /// Returns standard normal noise, which is different in each call.
    at::Tensor normal_like(const at::Tensor& latents);
};
IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration);

at::Tensor timestep_weight(Weighting weighting, const at::Tensor& alphas_cumprod);

/// Returns the output of a step. It has this process's rows of `gradient`, and the length of
/// `direction`, which is not weighted. unet_began: seconds_now() before the first prediction.
GuidanceOutput finish_step(const NoisedLatents& start, const at::Tensor& direction,
                           const at::Tensor& gradient, double unet_began);

double seconds_now();
float root_mean_square(const at::Tensor& tensor);

}  // namespace item3d
