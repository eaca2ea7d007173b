#include "item3d/baselines/instruct.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/diffusion_networks.h"

#include <algorithm>
#include <cmath>

namespace item3d {

bool takes_instructions(const DiffusionModel& model) {
    return model.condition_channels() == model.latent_channels();
}

at::Tensor three_way(const at::Tensor& full, const at::Tensor& image, const at::Tensor& none,
                     InstructScales scales) {
    return none + scales.text * (full - image) + scales.image * (image - none);
}

InstructedModel::InstructedModel(const DiffusionModel& model, const std::string& instruction,
                                 const std::string& negative_prompt, InstructScales scales,
                                 const std::string& subject)
    : model_(model), scales_(scales) {
    if (!takes_instructions(model))
        throw InputError(subject,
                         "is not an InstructPix2Pix: its U-Net has " +
                             std::to_string(model.latent_channels() + model.condition_channels()) +
                             " input channels, expected " +
                             std::to_string(2 * model.latent_channels()),
                         "run item3d prior pull timbrooks/instruct-pix2pix, then use --prior "
                         "timbrooks/instruct-pix2pix");
    text_ = model.encode_text({instruction});
    none_ = negative_prompt.empty() ? model.encode_no_text() : model.encode_text({negative_prompt});
}

at::Tensor InstructedModel::image_latents(const at::Tensor& images) const {
    const at::NoGradGuard no_grad;
    return model_.encode_image(images * 2 - 1) / model_.networks().vae->scaling_factor();
}

at::Tensor InstructedModel::operator()(const at::Tensor& latents, double timestep,
                                       const at::Tensor& image_latents) const {
    const at::NoGradGuard no_grad;
    const std::int64_t rows = latents.size(0);
    const TextEmbedding none = none_.expand(rows);
    const TextEmbedding texts =
        TextEmbedding::join(TextEmbedding::join(text_.expand(rows), none), none);
    const at::Tensor output = model_.predict(
        at::cat({latents, latents, latents}), at::full({3 * rows}, timestep, latents.options()),
        texts, at::cat({image_latents, image_latents, at::zeros_like(image_latents)}));
    const auto parts = output.chunk(3);
    return three_way(parts[0], parts[1], parts[2], scales_);
}

at::Tensor InstructedModel::edit(const at::Tensor& current, const at::Tensor& original,
                                 std::int64_t from, int steps, const at::Tensor& noise) const {
    const at::NoGradGuard no_grad;
    const NoiseSchedule& schedule = model_.schedule();
    const std::int64_t last = schedule.config().num_train_timesteps - 1;
    const std::int64_t count = std::clamp<std::int64_t>(steps, 1, std::max<std::int64_t>(1, from));
    const std::int64_t stride = std::max<std::int64_t>(1, from / count);
    const auto timestep = [&](std::int64_t i) {  // "leading" spacing, as in the published scheduler
        return std::clamp<std::int64_t>((count - 1 - i) * stride + schedule.config().steps_offset,
                                        0, last);
    };
    const auto alpha = [&](std::int64_t t) {
        // With set_alpha_to_one the result of the last step is noise-free.
        if (t < 0 && schedule.config().set_alpha_to_one) return 1.0;
        return schedule.alphas_cumprod()[std::max<std::int64_t>(t, 0)].item<double>();
    };
    const at::Tensor image = image_latents(original);
    const at::Tensor begun = model_.encode_image(current * 2 - 1);
    const double first = alpha(timestep(0));
    at::Tensor latents = std::sqrt(first) * begun + std::sqrt(1 - first) * noise;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t t = timestep(i);
        const at::Tensor output = (*this)(latents, static_cast<double>(t), image);
        const Prediction predicted = schedule.interpret(output, latents, alpha(t));
        const double next = alpha(t - stride);
        latents = std::sqrt(next) * predicted.clean + std::sqrt(1 - next) * predicted.noise;
        if (interrupted()) throw Interrupted("while editing a view");
    }
    return (model_.decode_image(latents) / 2 + 0.5).clamp(0, 1);
}

}  // namespace item3d
