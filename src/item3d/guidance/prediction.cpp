#include "item3d/guidance/prediction.h"

#include "item3d/processes/shared_rows.h"

#include <cmath>

namespace item3d {
namespace {

/// Returns rows [first, first + count).
at::Tensor narrow(const at::Tensor& all, std::int64_t first, std::int64_t count) {
    return all.defined() ? all.narrow(0, first, count) : all;
}

}  // namespace

NoisyInput noisy_input(const NoisedLatents& start) {
    return {start.noisy, start.timesteps, start.condition, start.processes};
}

NoisyInput noisy_input(const NoisedLatents& start, const at::Tensor& latents,
                       std::int64_t timestep) {
    return {latents, at::full_like(start.timesteps, timestep), start.condition, start.processes};
}

TextEmbedding encode_base(const DiffusionModel& pipeline, const GuidanceOptions& options) {
    return options.negative_prompt.empty() ? pipeline.encode_no_text()
                                           : pipeline.encode_text({options.negative_prompt});
}

TextEmbedding encode_negative(const DiffusionModel& pipeline, const GuidanceOptions& options) {
    return pipeline.encode_text(
        {options.negative_prompt.empty() ? default_negative_prompt() : options.negative_prompt});
}

std::vector<at::Tensor> predict_each(const DiffusionModel& pipeline, const NoisyInput& input,
                                     const std::vector<TextEmbedding>& texts) {
    const at::NoGradGuard no_grad;
    const std::int64_t rows = input.latents.size(0);
    const auto count = static_cast<std::int64_t>(texts.size());
    TextEmbedding text = texts.front().expand(rows);
    for (std::size_t i = 1; i < texts.size(); ++i)
        text = TextEmbedding::join(text, texts[i].expand(rows));
    const auto repeated = [&](const at::Tensor& tensor) {
        if (!tensor.defined()) return tensor;
        std::vector<at::Tensor> copies(texts.size(), tensor);
        return at::cat(copies);
    };
    const at::Tensor latents = repeated(input.latents), timesteps = repeated(input.timesteps),
                     condition = repeated(input.condition);
    const auto predict = [&](std::int64_t first, std::int64_t part) {
        return pipeline.predict_noise(
            narrow(latents, first, part), narrow(timesteps, first, part),
            {narrow(text.states, first, part), narrow(text.pooled, first, part)},
            narrow(condition, first, part));
    };
    return compute_rows(input.processes, rows * count, latents.sizes().slice(1), latents.options(),
                        predict)
        .chunk(count);
}

at::Tensor predict_guided(const DiffusionModel& pipeline, const NoisyInput& input,
                          const TextEmbedding& text, const TextEmbedding& base,
                          double guidance_scale) {
    const at::NoGradGuard no_grad;
    const auto predictions = predict_each(pipeline, input, {text, base});
    return predictions[1] + guidance_scale * (predictions[0] - predictions[1]);
}

at::Tensor denoising_loss(const DiffusionModel& pipeline, const at::Tensor& prediction,
                          const NoisedLatents& latents) {
    at::Tensor error = prediction - latents.noise;
    // The error of the velocity is the error of eps divided by sqrt(abar).
    if (pipeline.schedule().predicts_velocity()) error = error / latents.alphas_cumprod.sqrt();
    return error.square().mean();
}

double alpha_at(const DiffusionModel& pipeline, std::int64_t timestep) {
    return pipeline.schedule().alphas_cumprod()[timestep].item<double>();
}

at::Tensor clean_latents(const at::Tensor& noisy, const at::Tensor& noise, double alpha) {
    return (noisy - std::sqrt(1 - alpha) * noise) / std::sqrt(alpha);
}

at::Tensor add_noise(const at::Tensor& clean, const at::Tensor& noise, double alpha) {
    return std::sqrt(alpha) * clean + std::sqrt(1 - alpha) * noise;
}

}  // namespace item3d
