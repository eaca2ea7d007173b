// Interface of a text-to-image diffusion model, for the guidance of edits and for sampling.
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

struct DiffusionNetworks;  // diffusion_networks.h, which includes torch::nn

/// Base class of Pipeline, which can be saved, and of RunningPipeline, which needs less memory.
class DiffusionModel {
  public:
    virtual ~DiffusionModel();

    /// Encodes prompts to float32 embeddings, one for each prompt; see TextEncoders::encode().
    virtual TextEmbedding encode_text(const std::vector<std::string>& prompts) const = 0;
    /// Returns the unconditional embedding of classifier-free guidance, for one image. This is the
    /// embedding of the empty prompt, or zeros if model_index.json says
    /// force_zeros_for_empty_prompt (SDXL).
    TextEmbedding encode_no_text() const;

    /// Encodes images [N, 3, H, W] in [-1, 1] to scaled latents [N, C, h, w] (mean of the
    /// posterior), float32. Differentiable in images.
    at::Tensor encode_image(const at::Tensor& images) const;
    /// Decodes scaled latents to images in [-1, 1], not clamped, float32. Throws InputError if the
    /// images have numbers that are not finite.
    at::Tensor decode_image(const at::Tensor& latents) const;
    /// Returns the U-Net's noise prediction eps (v-prediction is converted), float32. text: N
    /// embeddings, or one for all. condition: extra input channels [N, c, h, w] (or [1, c, h, w]
    /// for all); they are concatenated to the latents if the U-Net has such channels. An undefined
    /// condition means zeros, which the embedded prior takes for "no shape". With a ControlNet,
    /// `condition` is its image [N, 3, H, W]; an undefined one skips the ControlNet. SDXL's size
    /// condition is that of an image that was neither scaled nor cropped. Differentiable in every
    /// input that requires a gradient.
    at::Tensor predict_noise(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                             const TextEmbedding& text, const at::Tensor& condition = {}) const;
    /// Returns the U-Net's own output, of the scheduler's prediction_type, before predict_noise
    /// converts it.
    at::Tensor predict(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                       const TextEmbedding& text, const at::Tensor& condition = {}) const;

    /// Returns the cross-attention maps of the S text tokens, [N, S, h, w] float32 on the latents'
    /// grid. A map is the mean over heads and layers (AttentionMaps). Inputs are as for
    /// predict_noise.
    at::Tensor cross_attention(const at::Tensor& noisy_latents, const at::Tensor& timesteps,
                               const TextEmbedding& text, const at::Tensor& condition = {}) const;

    /// Number of latents that the U-Net has processed since it was loaded. Each element of a batch
    /// counts. The number measures the cost of a method.
    std::int64_t predicted_rows() const { return *predicted_rows_; }

    const NoiseSchedule& schedule() const;
    const ClipTokenizer& tokenizer() const { return *tokenizer_; }
    bool is_sdxl() const { return sdxl_; }  ///< true with a second text encoder
    int latent_channels() const;
    int condition_channels() const;  ///< in_channels - latent_channels (shape_condition.h)
    /// Pixels of the ControlNet's image per latent cell, along one side; 0 without a ControlNet.
    int controlnet_downscale() const;
    int downscale() const;  ///< image pixels per latent cell, along one side (4 or 8)
    /// Pixels along one side of the square images that the U-Net was trained on.
    int native_size() const;
    at::Device device() const;

    /// Turns recomputation in the autoencoder's backward pass on or off. It takes less memory and
    /// more time.
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
