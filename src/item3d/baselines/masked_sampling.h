// Sampling that keeps a part of an image, in two ways: with blended latents (Avrahami et al. 2022)
// and an ordinary U-Net, or with an inpainting U-Net, which has 9 input channels.
#pragma once

#include "item3d/core/random.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>
#include <string>

namespace item3d {

/// A network and its encoded prompts.
struct GuidedModel {
    const DiffusionModel& model;
    TextEmbedding text, without;  ///< the prompt; the negative prompt, or no text
    float scale = 7.5f;           ///< w in the output without + w (text - without)
    at::Tensor condition = {};    ///< see DiffusionModel::predict()

    GuidedModel(const DiffusionModel& network, const std::string& prompt,
                const std::string& negative_prompt, float guidance_scale);
    /// Maps latents [N, C, h, w] to the guided output of the network. The U-Net computes a batch of
    /// 2 N rows.
    at::Tensor operator()(const at::Tensor& latents, double timestep) const;
};

/// Returns the condition of a U-Net with 9 input channels. mask: [1, 1, h, w], 1 in the part to
/// draw; masked_latents: latents of the image without that part.
at::Tensor inpainting_condition(const at::Tensor& mask, const at::Tensor& masked_latents);
/// True if the U-Net takes an inpainting_condition().
bool is_inpainter(const DiffusionModel& model);

struct MaskedSampling {
    std::string sampler = "ddim";  ///< one of sampler_kinds()
    int steps = 50;
    double strength = 1;  ///< share of the steps that run; below 1 they begin with the noised image
    double eta = 0;       ///< noise of stochastic steps, only for "ddim"
    at::Tensor image;     ///< [1, C, h, w] scaled latents of the image
    at::Tensor noise;     ///< [1, C, h, w]: the initial noise, also added to the kept part
    std::uint64_t seed = 0;  ///< for the noise of stochastic steps
    /// Returns the mask [1, 1, h, w] of a step: 1 where the step draws, 0 where the image is kept,
    /// with the step's level of noise. With strength 1 the first step sees only noise, as in
    /// diffusers. If null, everything is drawn.
    std::function<at::Tensor(int)> drawn;
    /// Another network, used in the steps for which `inpaints` is true, or in all steps if
    /// `inpaints` is null. May be null.
    const GuidedModel* inpainter = nullptr;
    std::function<bool(int)> inpaints;
};

/// Returns scaled latents [1, C, h, w]. Throws Interrupted after Ctrl-C.
at::Tensor sample_masked(const GuidedModel& model, const MaskedSampling& sampling);

/// Uses of random numbers by the methods. Each use has its own range of one stream
/// (RandomStream::baseline); the value of the enumerator is the range's beginning.
enum class BaselineDraw : std::uint64_t {
    views = 0,                 ///< initial noise of a view
    view_steps = 1u << 20,     ///< noise of a step of a view
    texture_steps = 2u << 20,  ///< noise of a step in texture space
    backgrounds = 3u << 20,    ///< colours of backgrounds
    levels = 4u << 20,         ///< noise levels of edited images
    images = 5u << 20,         ///< noise of edited images
    choices = 6u << 20,        ///< views of an iteration
};
Random seeded_random(std::uint64_t seed, BaselineDraw draw, std::uint64_t index);
/// Returns standard normal numbers on the CPU, deterministic in (seed, draw, index).
at::Tensor seeded_noise(at::IntArrayRef sizes, std::uint64_t seed, BaselineDraw draw,
                        std::uint64_t index);

}  // namespace item3d
