// What guidance and sampling ask of a text-to-image diffusion model.
#pragma once

#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/text_embedding.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct DiffusionNetworks;  // diffusion_networks.h: it declares torch::nn, which few need

/// The base of Pipeline, which can be saved, and of RunningPipeline, which runs in less memory.
class DiffusionModel {
  public:
    virtual ~DiffusionModel();

    /// float32, a row for each prompt; see TextEncoders::encode().
    virtual TextEmbedding encode_text(const std::vector<std::string>& prompts) const = 0;
    /// One row: what classifier-free guidance goes away from when nobody says what. The empty
    /// prompt, or zeros where model_index.json says force_zeros_for_empty_prompt (SDXL).
    TextEmbedding encode_no_text() const;

    /// images [N, 3, H, W] in [-1, 1] -> latents [N, C, h, w], scaled (mean of the posterior);
    /// differentiable in images. float32.
    at::Tensor encode_image(const at::Tensor& images) const;
    /// Inverse of encode_image, images in [-1, 1], not clamped. float32.
    at::Tensor decode_image(const at::Tensor& latents) const;
    /// U-Net's noise prediction eps (v-prediction is converted), float32. `condition`: extra input
    /// channels [N, c, h, w] (or one row for all), concatenated to the latents where the U-Net
    /// takes them; left out, they are zero, which the embedded prior knows as "no shape". text: N
    /// rows or one for all. SDXL is told that the picture is neither scaled nor cropped.
    /// Differentiable in whatever asks for it. With a ControlNet, `condition` is its picture [N, 3,
    /// H, W]; left out, the ControlNet is not asked.
    at::Tensor predict_noise(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                             const TextEmbedding& text, const at::Tensor& condition = {}) const;
    /// What predict_noise converts: the U-Net's own output, of the scheduler's prediction_type.
    at::Tensor predict(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                       const TextEmbedding& text, const at::Tensor& condition = {}) const;

    /// Where the U-Net reads which token of the text: [N, S, h, w] float32 on the latents' grid,
    /// the mean of its cross-attention over heads and layers (AttentionMaps). Inputs as
    /// predict_noise.
    at::Tensor cross_attention(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                               const TextEmbedding& text, const at::Tensor& condition = {}) const;

    /// Rows that the U-Net was asked for since it was loaded: what a method costs.
    std::int64_t predicted_rows() const { return *predicted_rows_; }

    const NoiseSchedule& schedule() const;
    const ClipTokenizer& tokenizer() const { return *tokenizer_; }
    bool is_sdxl() const { return sdxl_; }  ///< with a second text encoder
    int latent_channels() const;
    int condition_channels() const;  ///< in_channels - latent_channels (shape_condition.h)
    /// Pixels of the ControlNet's picture for a latent cell; 0 without a ControlNet.
    int controlnet_downscale() const;
    int downscale() const;    ///< image pixels a latent cell (4 or 8)
    int native_size() const;  ///< pixels of the square picture that the U-Net was made for
    at::Device device() const;

    /// Whether the autoencoder's backward pass computes activations anew: less memory, more time.
    void recompute_in_backward(bool recompute);

    const DiffusionNetworks& networks() const { return *networks_; }

  protected:
    DiffusionModel();
    std::shared_ptr<ClipTokenizer> tokenizer_;
    std::shared_ptr<DiffusionNetworks> networks_;
    bool sdxl_ = false;
    bool force_zeros_for_empty_prompt_ = false;

  private:
    at::Tensor run_unet(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                        const TextEmbedding& text, const at::Tensor& condition,
                        bool wants_attention) const;
    at::Tensor sizes_of(const at::Tensor& latents) const;

    std::shared_ptr<std::atomic<std::int64_t>> predicted_rows_ =
        std::make_shared<std::atomic<std::int64_t>>(0);
};

}  // namespace item3d
