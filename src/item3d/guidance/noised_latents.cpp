#include "item3d/guidance/noised_latents.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/guidance/timestep_schedule.h"
#include "item3d/networks/diffusion/shape_condition.h"

#include <ATen/CPUGeneratorImpl.h>

#include <chrono>

namespace item3d {

namespace {

// Streams of the edit's seed; those of cameras, backgrounds and lights are in edit/views.cpp, 6 and
// 7 in edit/render_view.cpp and edit/detail_stage.cpp.
enum Stream : std::uint64_t { noise_stream = 1, renoise_stream = 5, further_stream = 8 };

/// Numbers of one iteration; leaves room for two draws.
Random iteration_random(const GuidanceOptions& options, Stream stream, std::int64_t iteration) {
    return Random(options.seed, stream, static_cast<std::uint64_t>(iteration) * 2);
}

}  // namespace

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

float root_mean_square(const torch::Tensor& tensor) {
    return tensor.detach().to(torch::kFloat32).square().mean().sqrt().item<float>();
}

torch::Tensor timestep_weight(Weighting weighting, const torch::Tensor& alphas_cumprod) {
    switch (weighting) {
        case Weighting::early:
            return alphas_cumprod.sqrt() * (1 - alphas_cumprod);
        case Weighting::late:
            return 1 / (1 - alphas_cumprod);
        case Weighting::dreamfusion:
            return 1 - alphas_cumprod;
        case Weighting::uniform:
            return torch::ones_like(alphas_cumprod);
    }
    ITEM3D_CHECK(false, "unknown weighting");
}

torch::Tensor IterationDraws::normal_like(const torch::Tensor& latents) {
    return torch::randn(latents.sizes(), generator, torch::kFloat32).to(latents.device());
}

IterationDraws iteration_draws(const GuidanceOptions& options, std::int64_t iteration) {
    Random random = iteration_random(options, further_stream, iteration);
    const double uniform = random.uniform();
    return {uniform, at::detail::createCPUGenerator(random.bits())};
}

GuidanceOutput finish_step(const NoisedLatents& start, const torch::Tensor& direction,
                           const torch::Tensor& gradient, double unet_began) {
    GuidanceOutput output;
    output.latents = start.latents;
    output.latents_gradient = gradient;
    output.direction_length = root_mean_square(direction);
    output.seconds_encode = start.seconds_encode;
    output.seconds_unet = seconds_now() - unet_began;
    return output;
}

NoisedLatents noise_latents(const Pipeline& pipeline, const GuidanceInput& input,
                            const GuidanceOptions& options, std::int64_t iteration) {
    ITEM3D_CHECK(input.images.dim() == 4 && input.images.size(1) == 3,
                 "images must be [N, 3, H, W]");
    NoisedLatents result;
    const double start = seconds_now();
    result.latents = pipeline.encode_image(input.images * 2 - 1);
    if (input.reference.defined()) {
        ITEM3D_CHECK(input.reference.sizes() == input.images.sizes(),
                     "the reference must be as many and as large as the images");
        const torch::NoGradGuard no_grad;
        result.reference = pipeline.encode_image(input.reference * 2 - 1);
    }
    result.seconds_encode = seconds_now() - start;

    const torch::Tensor& schedule = pipeline.scheduler.alphas_cumprod();
    Random random = iteration_random(options, noise_stream, iteration);
    const std::int64_t timestep =
        scheduled_timestep(options, schedule.size(0), iteration, random.uniform());
    auto generator = at::detail::createCPUGenerator(random.bits());

    const torch::NoGradGuard no_grad;
    const torch::Device device = result.latents.device();
    const std::int64_t rows = result.latents.size(0);
    result.timesteps = torch::full({rows}, timestep, torch::kInt64).to(device);
    result.noise = torch::randn(result.latents.sizes(), generator, torch::kFloat32).to(device);
    result.alphas_cumprod =
        schedule[timestep].to(device).to(torch::kFloat32).expand({rows, 1, 1, 1});
    result.weight = timestep_weight(options.weighting, result.alphas_cumprod);
    result.noisy = result.alphas_cumprod.sqrt() * result.latents.detach() +
                   (1 - result.alphas_cumprod).sqrt() * result.noise;
    result.condition = condition_of_shape(pipeline, input.shape, result.latents);
    return result;
}

NoisedLatents renoise_latents(const Pipeline& pipeline, const NoisedLatents& start,
                              const GuidanceOptions& options, std::int64_t iteration, int count) {
    const torch::NoGradGuard no_grad;
    const torch::Tensor& schedule = pipeline.scheduler.alphas_cumprod();
    const auto training_steps = static_cast<double>(schedule.size(0));
    Random random = iteration_random(options, renoise_stream, iteration);
    const double offset = random.uniform();
    auto generator = at::detail::createCPUGenerator(random.bits());

    const std::int64_t rows = start.latents.size(0);
    const torch::Device device = start.latents.device();
    NoisedLatents result;
    result.latents = start.latents.detach().repeat_interleave(count, 0);
    result.timesteps = torch::empty({rows * count}, torch::kInt64);
    for (std::int64_t i = 0; i < rows * count; ++i) {
        const double place = (static_cast<double>(i % count) + offset) / count;
        const double part =
            options.min_timestep + place * (options.max_timestep - options.min_timestep);
        result.timesteps[i] = static_cast<std::int64_t>(part * training_steps);
    }
    result.timesteps = result.timesteps.to(device);
    result.noise = torch::randn(result.latents.sizes(), generator, torch::kFloat32).to(device);
    result.alphas_cumprod = pipeline.scheduler.alphas_at(result.timesteps).to(torch::kFloat32);
    result.noisy = pipeline.scheduler.add_noise(result.latents, result.noise, result.timesteps);
    if (start.condition.defined()) result.condition = start.condition.repeat_interleave(count, 0);
    return result;
}

NoisedLatents join_rows(const NoisedLatents& first, const NoisedLatents& second) {
    NoisedLatents joined;
    joined.latents = torch::cat({first.latents.detach(), second.latents.detach()});
    joined.noise = torch::cat({first.noise, second.noise});
    joined.noisy = torch::cat({first.noisy, second.noisy});
    joined.timesteps = torch::cat({first.timesteps, second.timesteps});
    joined.alphas_cumprod = torch::cat({first.alphas_cumprod, second.alphas_cumprod});
    if (first.condition.defined())
        joined.condition = torch::cat({first.condition, second.condition});
    return joined;
}

}  // namespace item3d
