// A text-to-image diffusion model in the diffusers layout, whole.
#pragma once

#include "item3d/models/autoencoder.h"
#include "item3d/models/clip_text.h"
#include "item3d/models/clip_tokenizer.h"
#include "item3d/models/ddim.h"
#include "item3d/models/unet.h"

#include <torch/torch.h>

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

    /// [N, S, D] float32: last hidden states of padded and truncated prompts.
    torch::Tensor encode_text(const std::vector<std::string>& prompts) const;
    /// images [N, 3, H, W] in [-1, 1] -> latents [N, C, h, w], scaled (mean of the posterior);
    /// differentiable in images.
    torch::Tensor encode_image(const torch::Tensor& images) const;
    /// Inverse of encode_image, images in [-1, 1], not clamped.
    torch::Tensor decode_image(const torch::Tensor& latents) const;
    /// U-Net's noise prediction eps (v-prediction is converted), float32. `condition`: extra input
    /// channels [N, c, h, w], concatenated to the latents where the U-Net takes them.
    torch::Tensor predict_noise(const torch::Tensor& noisy_latents, const torch::Tensor& timesteps,
                                const torch::Tensor& text,
                                const torch::Tensor& condition = {}) const;

    int latent_channels() const;
    int condition_channels() const;  ///< in_channels - latent_channels (1: depth)
    int downscale() const;           ///< image pixels a latent cell (4 or 8)
    torch::Device device() const;

    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
    UNet2DCondition unet{nullptr};
    std::shared_ptr<Autoencoder> vae;
    DdimScheduler scheduler;
};

/// Depth as the U-Net's fifth channel wants it: z-depth [N, H, W] (0: nothing there) -> [N, 1, h,
/// w] on the latents' grid: disparity scaled an image to 0.2 (far) .. 1 (near), background -1,
/// averaged over each latent cell.
torch::Tensor depth_condition(const torch::Tensor& depth, int downscale);

struct GenerateOptions {
    std::string prompt;
    std::string negative_prompt;
    int steps = 30;
    float guidance_scale = 7.5f;
    int width = 0;  ///< pixels; 0: the U-Net's sample_size
    int height = 0;
    int count = 1;
    std::uint64_t seed = 0;
};

/// DDIM sampling with classifier-free guidance; images [count, H, W, 3] in [0, 1] (sRGB).
torch::Tensor generate(const Pipeline& pipeline, const GenerateOptions& options,
                       const torch::Tensor& condition = {});

}  // namespace item3d
