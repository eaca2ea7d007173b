// Pictures from a prompt.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/processes/process_group.h"

#include <cstdint>
#include <optional>
#include <string>

namespace item3d {

struct GenerateOptions {
    std::string prompt;
    std::optional<std::string> negative_prompt;  ///< without one: encode_no_text()
    std::string scheduler;  ///< a name of sampler_kinds(); empty: the folder's own
    int steps = 30;
    float guidance_scale = 7.5f;
    int width = 0;  ///< pixels, a multiple of downscale(); 0: the U-Net's sample_size
    int height = 0;
    int count = 1;
    std::uint64_t seed = 0;
    at::Tensor latents;  ///< [count, C, h, w] standard normal to start from; empty: by seed
    /// [count, C, h, w] scaled latents of pictures to begin from instead of noise alone, and how
    /// much of the schedule is walked again: 1 forgets them, 0 leaves them (SDEdit, Meng et al.
    /// 2022).
    at::Tensor image;
    double strength = 1;
    /// [1, 1, h, w] of 0 and 1. Where it is 1, `image` stays, and the rest is drawn to go with it
    /// (Avrahami et al. 2022, "Blended Diffusion"). Undefined: nothing stays.
    at::Tensor keep;
    /// Of scheduler "ddim" alone. 1: fresh noise in each step, as DDPM; small priors draw more
    /// detail with it.
    double eta = 0;
    bool show_progress = true;
    /// Processes that ask for the same pictures share out the rows of each step.
    ProcessGroup processes = {};
};

/// Sampling with classifier-free guidance; images [count, H, W, 3] in [0, 1] (sRGB).
/// condition: [1 or count, c, h, w], see predict_noise. Throws InputError for a size, a scheduler
/// or a number of steps that the model cannot do, Interrupted after Ctrl-C.
at::Tensor generate(const DiffusionModel& model, const GenerateOptions& options,
                    const at::Tensor& condition = {});
/// The same up to the scaled latents [count, C, h, w], before decoding.
at::Tensor generate_latents(const DiffusionModel& model, const GenerateOptions& options,
                            const at::Tensor& condition = {});

}  // namespace item3d
