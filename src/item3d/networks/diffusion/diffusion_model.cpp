#include "item3d/networks/diffusion/diffusion_model.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/layers/row_groups.h"
#include "item3d/tensors/precision.h"

#include <ATen/autocast_mode.h>

namespace item3d {
namespace {

/// True for a small network with frozen weights on the CPU. Its operations are too short to be
/// parallelised one by one.
bool runs_in_row_groups(const UNet2DConditionImpl& unet) {
    constexpr std::int64_t max_weights = 50'000'000;
    std::int64_t weights = 0;
    for (const at::Tensor& parameter : unet.parameters()) {
        if (!parameter.is_cpu() || parameter.requires_grad()) return false;
        weights += parameter.numel();
    }
    return weights <= max_weights && !at::autocast::is_autocast_enabled(at::kCPU);
}

}  // namespace

DiffusionModel::DiffusionModel() = default;
DiffusionModel::~DiffusionModel() = default;

TextEmbedding DiffusionModel::encode_no_text() const {
    const TextEmbedding text = encode_text({""});
    if (!force_zeros_for_empty_prompt_) return text;
    return {at::zeros_like(text.states),
            text.pooled.defined() ? at::zeros_like(text.pooled) : at::Tensor()};
}

at::Tensor DiffusionModel::encode_image(const at::Tensor& images) const {
    const at::Tensor latents =
        networks_->vae->encode(images.contiguous(at::MemoryFormat::ChannelsLast)).to(at::kFloat);
    return (latents - networks_->vae->shift_factor()) * networks_->vae->scaling_factor();
}

at::Tensor DiffusionModel::decode_image(const at::Tensor& latents) const {
    const at::Tensor unscaled =
        latents / networks_->vae->scaling_factor() + networks_->vae->shift_factor();
    const at::Tensor images =
        networks_->vae->decode(unscaled.contiguous(at::MemoryFormat::ChannelsLast)).to(at::kFloat);
    if (!images.isfinite().all().item<bool>())
        throw InputError("prior", "its networks computed an image of numbers that are not finite",
                         overflow_hint);
    return images;
}

at::Tensor DiffusionModel::predict(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                                   const TextEmbedding& text, const at::Tensor& condition) const {
    return run_unet(noisy_latents, timesteps, text, condition, false);
}

at::Tensor DiffusionModel::cross_attention(const at::Tensor& noisy_latents,
                                           const at::Tensor& timesteps, const TextEmbedding& text,
                                           const at::Tensor& condition) const {
    const at::NoGradGuard no_grad;
    return run_unet(noisy_latents, timesteps, text, condition, true);
}

at::Tensor DiffusionModel::run_unet(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                                    const TextEmbedding& text, const at::Tensor& condition,
                                    bool wants_attention) const {
    const auto rows = noisy_latents.size(0);
    *predicted_rows_ += rows;
    at::Tensor sample = noisy_latents;
    const TextEmbedding each = text.expand(rows);
    AddedCondition added;
    if (sdxl_) added = {each.pooled, sizes_of(noisy_latents)};
    UNetResiduals residuals;
    if (!networks_->controlnet.is_empty() && condition.defined()) {
        ControlNet network = networks_->controlnet;
        residuals = network(sample, timesteps, each.states, condition.expand({rows, -1, -1, -1}),
                            networks_->controlnet_scale, added);
    }
    if (const int channels = condition_channels()) {
        at::Tensor extra = condition;
        if (!extra.defined())
            extra = at::zeros({1, channels, sample.size(2), sample.size(3)}, sample.options());
        ITEM3D_CHECK(extra.size(1) == channels && extra.size(2) == sample.size(2) &&
                         extra.size(3) == sample.size(3),
                     "the condition must be on the latents' grid");
        sample = at::cat({sample, extra.to(sample.options()).expand({rows, -1, -1, -1})}, 1);
    }
    UNet2DCondition network = networks_->unet;
    const auto run = [&](const at::Tensor& samples, const at::Tensor& times,
                         const at::Tensor& states) {
        AttentionMaps maps(samples.size(2), samples.size(3));
        const at::Tensor output =
            network->forward(samples.contiguous(at::MemoryFormat::ChannelsLast), times, states,
                             added, residuals, wants_attention ? &maps : nullptr);
        return wants_attention ? maps.mean() : output.to(at::kFloat);
    };
    const bool alone = added.text_embeds.defined() || residuals.mid.defined() ||
                       sample.requires_grad() || !runs_in_row_groups(*network);
    if (rows == 1 || alone) return run(sample, timesteps, each.states);
    const at::Tensor times = timesteps.expand({rows});
    return in_row_groups(each.states, [&](auto first, auto count, const at::Tensor& states) {
        return run(sample.narrow(0, first, count), times.narrow(0, first, count), states);
    });
}

at::Tensor DiffusionModel::sizes_of(const at::Tensor& latents) const {
    const auto height = static_cast<float>(latents.size(2) * downscale());
    const auto width = static_cast<float>(latents.size(3) * downscale());
    return at::tensor({height, width, 0.0f, 0.0f, height, width})
        .to(latents.device())
        .expand({latents.size(0), image_sizes});
}

at::Tensor DiffusionModel::predict_noise(const at::Tensor& noisy_latents,
                                         const at::Tensor& timesteps, const TextEmbedding& text,
                                         const at::Tensor& condition) const {
    return schedule().to_noise(predict(noisy_latents, timesteps, text, condition), noisy_latents,
                               timesteps);
}

const NoiseSchedule& DiffusionModel::schedule() const {
    return networks_->scheduler;
}

int DiffusionModel::latent_channels() const {
    return networks_->latent_channels();
}

int DiffusionModel::condition_channels() const {
    return networks_->condition_channels();
}

int DiffusionModel::controlnet_downscale() const {
    const ControlNet& controlnet = networks_->controlnet;
    return controlnet.is_empty() ? 0 : controlnet->config().downscale();
}

int DiffusionModel::downscale() const {
    return networks_->vae->downscale();
}

int DiffusionModel::native_size() const {
    return networks_->unet->config().sample_size * downscale();
}

at::Device DiffusionModel::device() const {
    return networks_->device();
}

void DiffusionModel::recompute_in_backward(bool recompute) {
    networks_->vae->recompute_in_backward(recompute);
}

}  // namespace item3d
