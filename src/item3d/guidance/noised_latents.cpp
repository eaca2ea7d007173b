#include "item3d/guidance/noised_latents.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/guidance/timestep_schedule.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/processes/shared_rows.h"

#include <ATen/CPUGeneratorImpl.h>

#include <chrono>

namespace item3d {

namespace {

/// Returns a source of random numbers for one iteration, which may draw at most two.
Random iteration_random(const GuidanceOptions& options, RandomStream stream,
                        std::int64_t iteration) {
    return Random(options.seed, stream, static_cast<std::uint64_t>(iteration) * 2);
}

/// Returns the scaled latents of images in [0, 1]. The number of images may be 0.
at::Tensor encode(const DiffusionModel& pipeline, const at::Tensor& images) {
    if (images.size(0) > 0) return pipeline.encode_image(images * 2 - 1);
    const int cell = pipeline.downscale();
    return at::empty({0, pipeline.latent_channels(), images.size(2) / cell, images.size(3) / cell},
                     images.options().requires_grad(false));
}

}  // namespace

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

float root_mean_square(const at::Tensor& tensor) {
    return tensor.detach().to(at::kFloat).square().mean().sqrt().item<float>();
}

at::Tensor timestep_weight(Weighting weighting, const at::Tensor& alphas_cumprod) {
    switch (weighting) {
        case Weighting::early:
            return alphas_cumprod.sqrt() * (1 - alphas_cumprod);
        case Weighting::late:
            return 1 / (1 - alphas_cumprod);
        case Weighting::dreamfusion:
            return 1 - alphas_cumprod;
        case Weighting::uniform:
            return at::ones_like(alphas_cumprod);
    }
    ITEM3D_CHECK(false, "unknown weighting");
}

at::Tensor IterationDraws::normal_like(const at::Tensor& latents) {
    return at::randn(latents.sizes(), generator, at::kFloat).to(latents.device());
}

IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration) {
    Random random = iteration_random(options, RandomStream::further_noise, iteration);
    const double uniform = random.uniform();
    return {uniform, at::detail::createCPUGenerator(random.bits())};
}

GuidanceOutput finish_step(const NoisedLatents& start, const at::Tensor& direction,
                           const at::Tensor& gradient, double unet_began) {
    GuidanceOutput output;
    output.latents = start.own;
    output.latents_gradient = gradient.narrow(0, start.first, start.own.size(0));
    output.direction_length = root_mean_square(direction);
    output.timestep = start.timesteps[0].item<std::int64_t>();
    output.noise_seed = start.noise_seed;
    output.seconds_encode = start.seconds_encode;
    output.seconds_unet = seconds_now() - unet_began;
    return output;
}

NoisedLatents noise_latents(const DiffusionModel& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration) {
    ITEM3D_CHECK(input.images.dim() == 4 && input.images.size(1) == 3,
                 "images must be [N, 3, H, W]");
    NoisedLatents result;
    const double start = seconds_now();
    result.processes = input.processes;
    result.first = input.first;
    const auto of_all = [&](const at::Tensor& own) {
        return gather_rows(input.processes, own, input.first, input.views());
    };
    result.own = encode(pipeline, input.images);
    result.latents = of_all(result.own.detach());
    if (input.reference.defined()) {
        ITEM3D_CHECK(input.reference.sizes() == input.images.sizes(),
                     "the reference must be as many and as large as the images");
        const at::NoGradGuard no_grad;
        result.reference = of_all(encode(pipeline, input.reference));
    }
    result.seconds_encode = seconds_now() - start;

    const at::Tensor& schedule = pipeline.schedule().alphas_cumprod();
    Random random = iteration_random(options, RandomStream::noise, iteration);
    const std::int64_t timestep =
        scheduled_timestep(options, schedule.size(0), iteration, random.uniform());
    result.noise_seed = random.bits();
    auto generator = at::detail::createCPUGenerator(result.noise_seed);

    const at::NoGradGuard no_grad;
    const at::Device device = result.latents.device();
    const std::int64_t rows = result.latents.size(0);
    result.timesteps = at::full({rows}, timestep, at::kLong).to(device);
    result.noise = at::randn(result.latents.sizes(), generator, at::kFloat).to(device);
    result.alphas_cumprod = schedule[timestep].to(device).to(at::kFloat).expand({rows, 1, 1, 1});
    result.weight = timestep_weight(options.weighting, result.alphas_cumprod);
    result.noisy = result.alphas_cumprod.sqrt() * result.latents +
                   (1 - result.alphas_cumprod).sqrt() * result.noise;
    result.condition = condition_of_shape(pipeline, input.shape, result.own);
    if (result.condition.defined()) result.condition = of_all(result.condition);
    return result;
}

NoisedLatents renoise_latents(const DiffusionModel& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count) {
    const at::NoGradGuard no_grad;
    const at::Tensor& schedule = pipeline.schedule().alphas_cumprod();
    const auto training_steps = static_cast<double>(schedule.size(0));
    Random random = iteration_random(options, RandomStream::renoise, iteration);
    const double offset = random.uniform();
    auto generator = at::detail::createCPUGenerator(random.bits());

    const std::int64_t rows = start.latents.size(0);
    const at::Device device = start.latents.device();
    NoisedLatents result;
    result.latents = start.latents.repeat_interleave(count, 0);
    result.timesteps = at::empty({rows * count}, at::kLong);
    for (std::int64_t i = 0; i < rows * count; ++i) {
        const double place = (static_cast<double>(i % count) + offset) / count;
        const double part =
            options.min_timestep + place * (options.max_timestep - options.min_timestep);
        result.timesteps[i] = static_cast<std::int64_t>(part * training_steps);
    }
    result.timesteps = result.timesteps.to(device);
    result.noise = at::randn(result.latents.sizes(), generator, at::kFloat).to(device);
    result.alphas_cumprod = pipeline.schedule().alphas_at(result.timesteps).to(at::kFloat);
    result.noisy = pipeline.schedule().add_noise(result.latents, result.noise, result.timesteps);
    if (start.condition.defined()) result.condition = start.condition.repeat_interleave(count, 0);
    return result;
}

NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second) {
    NoisedLatents joined;
    joined.latents = at::cat({first.latents, second.latents});
    joined.noise = at::cat({first.noise, second.noise});
    joined.noisy = at::cat({first.noisy, second.noisy});
    joined.timesteps = at::cat({first.timesteps, second.timesteps});
    joined.alphas_cumprod = at::cat({first.alphas_cumprod, second.alphas_cumprod});
    if (first.condition.defined()) joined.condition = at::cat({first.condition, second.condition});
    joined.processes = first.processes;
    return joined;
}

NoisedLatents narrow_rows(const NoisedLatents& all, const Share& share) {
    const auto rows = [&](const at::Tensor& tensor) {
        return tensor.defined() ? tensor.narrow(0, share.first, share.count) : tensor;
    };
    NoisedLatents part;
    part.latents = rows(all.latents);
    part.noise = rows(all.noise);
    part.noisy = rows(all.noisy);
    part.timesteps = rows(all.timesteps);
    part.alphas_cumprod = rows(all.alphas_cumprod);
    part.condition = rows(all.condition);
    part.processes = all.processes;
    return part;
}

}  // namespace item3d
