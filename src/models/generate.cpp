// Pictures from a prompt: depth_condition() and generate() of pipeline.h.
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/models/pipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace item3d {
namespace {

/// A stream for each picture: it does not change when more of them are asked for. Stream 0 of a
/// picture is what it starts from, the others belong to the steps.
torch::Tensor noise_like(const torch::Tensor& latents, std::uint64_t seed, int step) {
    torch::Tensor noise = torch::empty(latents.sizes(), torch::kFloat32);
    const std::int64_t count = noise.size(0);
    const std::int64_t each = noise.numel() / count;
    for (std::int64_t i = 0; i < count; ++i) {
        Random random(seed,
                      static_cast<std::uint64_t>(i) + (static_cast<std::uint64_t>(step) << 32));
        float* values = noise.data_ptr<float>() + i * each;
        for (std::int64_t j = 0; j < each; ++j)
            values[j] = static_cast<float>(random.normal());
    }
    return noise.to(latents.device());
}

/// Latents of the size that is asked for, without content.
torch::Tensor empty_latents(const Pipeline& pipeline, const GenerateOptions& options) {
    const int cell = pipeline.downscale();
    const int native = pipeline.unet->config().sample_size * cell;
    const int width = options.width > 0 ? options.width : native;
    const int height = options.height > 0 ? options.height : native;
    if (width % cell != 0 || height % cell != 0)
        throw InputError(fmt::format("size {}x{}", width, height),
                         fmt::format("this model makes sizes that are multiples of {}", cell));
    return torch::empty({options.count, pipeline.latent_channels(), height / cell, width / cell},
                        pipeline.device());
}

/// What sampling starts from when `skipped` timesteps are left out.
torch::Tensor starting_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const DdimScheduler& scheduler, int skipped) {
    if (options.image.defined()) {
        const torch::Tensor image = options.image.to(pipeline.device(), torch::kFloat32);
        const torch::Tensor timesteps =
            torch::full({image.size(0)}, scheduler.timesteps()[skipped], torch::kInt64);
        return scheduler.add_noise(image, noise_like(image, options.seed, 0),
                                   timesteps.to(image.device()));
    }
    const torch::Tensor noise = options.latents.defined()
                                    ? options.latents.to(pipeline.device(), torch::kFloat32)
                                    : noise_like(empty_latents(pipeline, options), options.seed, 0);
    return noise * scheduler.init_noise_sigma();
}

}  // namespace

torch::Tensor depth_condition(const torch::Tensor& depth, int downscale) {
    ITEM3D_CHECK(depth.dim() == 3, "depth must be [N, H, W]");
    const torch::NoGradGuard no_grad;
    const float infinity = std::numeric_limits<float>::infinity();
    const torch::Tensor covered = depth > 0;
    const torch::Tensor disparity = torch::where(covered, 1 / depth.clamp_min(1e-6), 0.0);
    const torch::Tensor near = disparity.amax({1, 2}, true);
    const torch::Tensor far =
        disparity.masked_fill(covered.logical_not(), infinity).amin({1, 2}, true);
    const torch::Tensor relative = (disparity - far) / (near - far).clamp_min(1e-6);
    const torch::Tensor image = torch::where(covered, 0.2 + 0.8 * relative, -1.0);
    return torch::avg_pool2d(image.unsqueeze(1), downscale, downscale, 0, /*ceil_mode=*/true);
}

torch::Tensor generate_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const torch::Tensor& condition) {
    const torch::NoGradGuard no_grad;
    ITEM3D_CHECK(options.count >= 1, "count must be at least 1");
    DdimScheduler scheduler = pipeline.scheduler;
    const int most = scheduler.config().num_train_timesteps;
    if (options.steps < 1 || options.steps > most)
        throw InputError(fmt::format("{} steps", options.steps),
                         fmt::format("this model takes 1 to {}", most));
    scheduler.set_timesteps(options.steps);

    const double strength = options.image.defined() ? options.strength : 1.0;
    const int skipped =
        options.steps -
        std::clamp(static_cast<int>(std::lround(options.steps * strength)), 0, options.steps);
    if (skipped == options.steps) return options.image.to(pipeline.device(), torch::kFloat32);
    torch::Tensor latents = starting_latents(pipeline, options, scheduler, skipped);
    const auto rows = latents.size(0);
    const bool guided = options.guidance_scale != 1.0f;
    torch::Tensor text = pipeline.encode_text({options.prompt}).expand({rows, -1, -1});
    if (guided)
        text = torch::cat(
            {pipeline.encode_text({options.negative_prompt}).expand({rows, -1, -1}), text});
    torch::Tensor extra = condition;
    if (extra.defined()) extra = extra.to(pipeline.device()).expand({rows, -1, -1, -1});
    if (extra.defined() && guided) extra = torch::cat({extra, extra});

    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("generate", options.steps - skipped);
    for (int i = skipped; i < options.steps; ++i) {
        const std::int64_t timestep = scheduler.timesteps()[i];
        const torch::Tensor input = guided ? torch::cat({latents, latents}) : latents;
        torch::Tensor output = pipeline.predict(
            input, torch::full({input.size(0)}, timestep, latents.device()).to(torch::kInt64), text,
            extra);
        if (guided) {
            const auto halves = output.chunk(2);
            output = halves[0] + options.guidance_scale * (halves[1] - halves[0]);
        }
        const torch::Tensor fresh =
            options.eta > 0 ? noise_like(latents, options.seed, i + 1) : torch::Tensor();
        latents = scheduler.step(output, timestep, latents, options.eta, fresh);
        if (progress) progress->update(i + 1 - skipped);
        if (interrupted()) throw Interrupted("generate: stopped");
    }
    return latents;
}

torch::Tensor generate(const Pipeline& pipeline, const GenerateOptions& options,
                       const torch::Tensor& condition) {
    const torch::NoGradGuard no_grad;
    const torch::Tensor images =
        pipeline.decode_image(generate_latents(pipeline, options, condition));
    return (images / 2 + 0.5).clamp(0, 1).permute({0, 2, 3, 1}).contiguous();
}

}  // namespace item3d
