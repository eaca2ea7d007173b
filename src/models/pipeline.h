// A text-to-image diffusion model in the diffusers layout, whole.
#pragma once

#include "item3d/models/autoencoder.h"
#include "item3d/models/clip_text.h"
#include "item3d/models/clip_tokenizer.h"
#include "item3d/models/ddim.h"
#include "item3d/models/unet.h"

#include <torch/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

class Pipeline {
  public:
    /// Reads model_index.json and its sub-folders (tokenizer, text_encoder, unet, vae, scheduler).
    /// Weights are cast once to `dtype` (text encoder and schedules stay float32). Throws
    /// InputError naming the file for anything missing, of the wrong shape, or unsupported.
    static Pipeline load(const std::filesystem::path& folder, torch::Device device = torch::kCPU,
                         torch::Dtype dtype = torch::kFloat32);
    /// Writes the same layout, weights as `dtype` (float32 or float16), each file atomically and
    /// model_index.json last, so that a folder that has one is whole.
    void save(const std::filesystem::path& folder, torch::Dtype dtype = torch::kFloat16) const;

    /// [N, S, D] float32: last hidden states of padded and truncated prompts.
    torch::Tensor encode_text(const std::vector<std::string>& prompts) const;
    /// images [N, 3, H, W] in [-1, 1] -> latents [N, C, h, w], scaled (mean of the posterior);
    /// differentiable in images. float32.
    torch::Tensor encode_image(const torch::Tensor& images) const;
    /// Inverse of encode_image, images in [-1, 1], not clamped. float32.
    torch::Tensor decode_image(const torch::Tensor& latents) const;
    /// U-Net's noise prediction eps (v-prediction is converted), float32. `condition`: extra input
    /// channels [N, c, h, w] (or one row for all), concatenated to the latents where the U-Net
    /// takes them; left out, they are zero, which the embedded prior knows as "no depth". text: [N,
    /// S, D] or one row for all. Differentiable in whatever asks for it.
    torch::Tensor predict_noise(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                                const torch::Tensor& text,
                                const torch::Tensor& condition = {}) const;

    /// What predict_noise converts: the U-Net's own output, of the scheduler's prediction_type.
    torch::Tensor predict(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                          const torch::Tensor& text, const torch::Tensor& condition = {}) const;

    int latent_channels() const;
    int condition_channels() const;  ///< in_channels - latent_channels (1: depth)
    int downscale() const;           ///< image pixels a latent cell (4 or 8)
    torch::Device device() const;

    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
    UNet2DCondition unet{nullptr};
    std::shared_ptr<Autoencoder> vae;
    DdimScheduler scheduler;

  private:
    void check_fit(const std::filesystem::path& folder) const;
};

/// Parts of a pipeline's folder, each into a sub-folder that must exist; for trainings that write
/// one part after another. Weights are written as `dtype`.
void save_unet(const std::filesystem::path& folder, const UNet2DCondition& unet,
               torch::Dtype dtype = torch::kFloat16);
void save_autoencoder(const std::filesystem::path& folder, const Autoencoder& autoencoder,
                      torch::Dtype dtype = torch::kFloat16);
void save_clip_text(const std::filesystem::path& folder, const ClipTextModel& model,
                    torch::Dtype dtype = torch::kFloat16);

/// Depth as the U-Net's fifth channel wants it: z-depth [N, H, W] (0: nothing there) -> [N, 1, h,
/// w] on the latents' grid: disparity scaled an image to 0.2 (far) .. 1 (near), background -1,
/// averaged over each latent cell.
torch::Tensor depth_condition(const torch::Tensor& depth, int downscale);

struct GenerateOptions {
    std::string prompt;
    std::string negative_prompt;
    int steps = 30;
    float guidance_scale = 7.5f;
    int width = 0;  ///< pixels, a multiple of downscale(); 0: the U-Net's sample_size
    int height = 0;
    int count = 1;
    std::uint64_t seed = 0;
    torch::Tensor latents;  ///< [count, C, h, w] standard normal to start from; empty: by seed
    /// [count, C, h, w] scaled latents of pictures to begin from instead of noise alone, and how
    /// much of the schedule is walked again: 1 forgets them, 0 leaves them (SDEdit, Meng et al.
    /// 2022).
    torch::Tensor image;
    double strength = 1;
    /// 0: DDIM; 1: fresh noise in each step, as DDPM. Small priors draw more detail with it.
    double eta = 0;
    bool show_progress = true;
};

/// DDIM sampling with classifier-free guidance; images [count, H, W, 3] in [0, 1] (sRGB).
/// condition: [1 or count, c, h, w], see predict_noise. Throws InputError for a size or a number of
/// steps that the model cannot do, Interrupted after Ctrl-C.
torch::Tensor generate(const Pipeline& pipeline, const GenerateOptions& options,
                       const torch::Tensor& condition = {});
/// The same up to the scaled latents [count, C, h, w], before decoding.
torch::Tensor generate_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const torch::Tensor& condition = {});

}  // namespace item3d
