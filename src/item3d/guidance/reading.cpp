#include "item3d/guidance/reading.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/guidance/prediction.h"

#include <ATen/CPUGeneratorImpl.h>

#include <vector>

namespace item3d {
namespace {

/// Returns each image under every draw of noise, with the draws of one image adjacent.
NoisyInput noised(const DiffusionModel& model, const GuidanceInput& input,
                  const ReadingOptions& options) {
    ITEM3D_CHECK(options.noises > 0 && options.strength > 0 && options.strength < 1,
                 "noise of a strength between 0 and 1");
    const at::Tensor clean = model.encode_image(input.images * 2 - 1);
    const at::Tensor latents = clean.repeat_interleave(options.noises, 0);
    const auto steps = static_cast<double>(model.schedule().alphas_cumprod().size(0));
    const auto timestep = static_cast<std::int64_t>(options.strength * steps);
    Random random(options.seed, RandomStream::reading);
    auto generator = at::detail::createCPUGenerator(random.bits());
    // Every image has the same draws.
    const at::Tensor noise =
        at::randn({options.noises, clean.size(1), clean.size(2), clean.size(3)}, generator,
                  at::kFloat)
            .to(latents.device())
            .repeat({clean.size(0), 1, 1, 1});
    NoisyInput result;
    result.timesteps = at::full({latents.size(0)}, timestep, at::kLong).to(latents.device());
    result.latents = model.schedule().add_noise(latents, noise, result.timesteps);
    result.condition = condition_of_shape(model, input.shape, clean);
    if (result.condition.defined())
        result.condition = result.condition.repeat_interleave(options.noises, 0);
    return result;
}

/// Averages [N * noises, ...] to [N, ...].
at::Tensor mean_of_draws(const at::Tensor& rows, int noises) {
    std::vector<std::int64_t> sizes(rows.sizes().begin() + 1, rows.sizes().end());
    sizes.insert(sizes.begin(), {rows.size(0) / noises, noises});
    return rows.reshape(sizes).mean(1);
}

}  // namespace

at::Tensor prediction_difference(const DiffusionModel& model, const GuidanceInput& input,
                                 const TextEmbedding& source, const TextEmbedding& target,
                                 const ReadingOptions& options) {
    const at::NoGradGuard no_grad;
    const auto predictions = predict_each(model, noised(model, input, options), {source, target});
    return mean_of_draws((predictions[1] - predictions[0]).abs().mean(1), options.noises);
}

at::Tensor normalize_difference(const at::Tensor& difference, double mean, double outlier) {
    ITEM3D_CHECK(outlier > 0, "outliers lie above 0");
    if (!(mean > 0)) return at::zeros_like(difference);
    return (difference / (outlier * mean)).clamp(0, 1);
}

at::Tensor mean_attention(const DiffusionModel& model, const GuidanceInput& input,
                          const TextEmbedding& text, const ReadingOptions& options) {
    const at::NoGradGuard no_grad;
    const NoisyInput noisy = noised(model, input, options);
    return mean_of_draws(
        model.cross_attention(noisy.latents, noisy.timesteps, text, noisy.condition),
        options.noises);
}

}  // namespace item3d
