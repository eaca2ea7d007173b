// Text-to-image sampling.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/processes/process_group.h"

#include <cstdint>
#include <optional>
#include <string>

namespace item3d {

struct GenerateOptions {
    std::string prompt;
    std::optional<std::string> negative_prompt;  ///< if unset, encode_no_text() is used
    std::string scheduler;  ///< a name of sampler_kinds(); empty for the folder's own
    int steps = 30;
    float guidance_scale = 7.5f;
    int width = 0;  ///< pixels, a multiple of downscale(); 0 for native_size()
    int height = 0;
    int count = 1;
    std::uint64_t seed = 0;
    /// Initial noise [count, C, h, w], standard normal. If undefined, it is drawn from `seed`.
    at::Tensor latents;
    /// Scaled latents [count, C, h, w] of the images to start from. `strength` is the fraction of
    /// the schedule to run: 1 ignores the images, 0 leaves them unchanged (SDEdit, Meng et al.
    /// 2022).
    at::Tensor image;
    double strength = 1;
    /// Mask [1, 1, h, w] of 0 and 1. Cells of 1 keep `image`. The other cells are generated to fit
    /// the kept ones (Avrahami et al. 2022, "Blended Diffusion"). If undefined, nothing is kept.
    at::Tensor keep;
    /// Amount of fresh noise in each step, for scheduler "ddim" only. 1 means as much as in DDPM,
    /// which gives small priors more detail.
    double eta = 0;
    bool show_progress = true;
    /// Processes that share the work. All must call the function with equal arguments; each
    /// computes a part of every step's batch.
    ProcessGroup processes = {};
};

/// Samples with classifier-free guidance. Returns images [count, H, W, 3] in [0, 1] (sRGB).
/// condition: [1 or count, c, h, w], see predict_noise. Throws InputError for a size, a scheduler
/// or a number of steps that the model does not support, and Interrupted after Ctrl-C.
at::Tensor generate(const DiffusionModel& model, const GenerateOptions& options,
                    const at::Tensor& condition = {});
/// Returns the scaled latents [count, C, h, w] of generate() before decoding.
at::Tensor generate_latents(const DiffusionModel& model, const GenerateOptions& options,
                            const at::Tensor& condition = {});

}  // namespace item3d
