// Sampling that leaves a part of a picture as it is: blended latents (Avrahami et al. 2022) with an
// ordinary U-Net, and the U-Net of 9 input channels that was trained to inpaint.
#pragma once

#include "item3d/core/random.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>
#include <string>

namespace item3d {

/// A network and what it is told; one row each.
struct GuidedModel {
    const DiffusionModel& model;
    TextEmbedding text, without;  ///< prompt, and what guidance goes away from
    float scale = 7.5f;           ///< w of without + w (text - without)
    at::Tensor condition = {};    ///< see DiffusionModel::predict()

    GuidedModel(const DiffusionModel& network, const std::string& prompt,
                const std::string& negative_prompt, float guidance_scale);
    /// latents [N, C, h, w] -> the network's own output, in 2 N rows of the U-Net.
    at::Tensor operator()(const at::Tensor& latents, double timestep) const;
};

/// The condition of a U-Net of 9 input channels: mask [1, 1, h, w] of what is drawn anew, and the
/// latents of the picture without that.
at::Tensor inpainting_condition(const at::Tensor& mask, const at::Tensor& masked_latents);
/// Whether the U-Net takes that.
bool is_inpainter(const DiffusionModel& model);

struct MaskedSampling {
    std::string sampler = "ddim";  ///< a name of sampler_kinds()
    int steps = 50;
    double strength = 1;     ///< below 1: begins with the noised picture
    double eta = 0;          ///< of "ddim" alone
    at::Tensor image;        ///< [1, C, h, w] scaled latents of the picture
    at::Tensor noise;        ///< the same: what it begins from, and the noise on what stays
    std::uint64_t seed = 0;  ///< of the noise of steps that draw some
    /// [1, 1, h, w] of a step: 1: drawn, 0: as the picture with that step's noise. Where strength
    /// is 1 the first step sees noise alone, as diffusers does it. Null: all is drawn.
    std::function<at::Tensor(int)> drawn;
    /// Another network, and which steps are its; null: none.
    const GuidedModel* inpainter = nullptr;
    std::function<bool(int)> inpaints;
};

/// Scaled latents [1, C, h, w]. Throws Interrupted after Ctrl-C.
at::Tensor sample_masked(const GuidedModel& model, const MaskedSampling& sampling);

/// Uses of random numbers by the methods: each has its own part of one stream, which begins at its
/// value.
enum class BaselineDraw : std::uint64_t {
    views = 0,                 ///< noise that a view begins from
    view_steps = 1u << 20,     ///< noise of a step of a view
    texture_steps = 2u << 20,  ///< noise of a step in texture space
    backgrounds = 3u << 20,    ///< colours behind views
    levels = 4u << 20,         ///< noise levels of pictures that are edited anew
    pictures = 5u << 20,       ///< their noise
    choices = 6u << 20,        ///< views of an iteration
};
Random seeded_random(std::uint64_t seed, BaselineDraw draw, std::uint64_t index);
/// Standard normal numbers of (seed, draw, index) alone, on the CPU.
at::Tensor seeded_noise(at::IntArrayRef sizes, std::uint64_t seed, BaselineDraw draw,
                        std::uint64_t index);

}  // namespace item3d
