// Down path and middle block of diffusers' U-Net, which a ControlNet copies.
#pragma once

#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/diffusion/unet_config.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <vector>

namespace item3d {

/// Second condition of SDXL; empty for other models.
struct AddedCondition {
    at::Tensor text_embeds;  ///< [N, P] pooled text
    at::Tensor time_ids;     ///< [N, 6] original size, crop corner, target size
};

/// Converts [N] timesteps of any type to [N, channels] float32 sinusoids (Vaswani et al. 2017).
at::Tensor sinusoidal_embedding(const at::Tensor& timesteps, int channels, bool flip_sin_to_cos,
                                double freq_shift);

/// One level of the down path, the middle block or the up path.
struct UNetLevel {
    std::vector<ResnetBlock> resnets;
    std::vector<SpatialTransformer> attentions;
    Downsample down{nullptr};
    Upsample up{nullptr};

    /// Returns a module with the layers of this level under diffusers' names, for registration.
    std::shared_ptr<torch::nn::Module> as_module() const;
};

class UNetEncoderImpl : public torch::nn::Module {
  public:
    explicit UNetEncoderImpl(const UNetEncoderConfig& config);

    /// The two stages of the time embedding: the sinusoids [N, block_out_channels[0]] of the
    /// timesteps, and the embedding [N, 4 x block_out_channels[0]] of the sinusoids.
    at::Tensor time_sinusoids(const at::Tensor& timesteps) const;
    at::Tensor time_embedding(const at::Tensor& sinusoids);

  protected:
    /// Returns the time input of every resnet, [N, 4 x block_out_channels[0]]: SiLU of the embedded
    /// timesteps ([N] or one), to which the embedded added condition is added if the model has such
    /// a condition.
    at::Tensor embed(const at::Tensor& timesteps, std::int64_t rows, const AddedCondition& added);
    /// Applies the first convolution: [N, in_channels, H, W] -> [N, block_out_channels[0], H, W].
    at::Tensor enter(const at::Tensor& sample) { return conv_in_(sample); }
    /// Runs the down path on x, the first convolution's output. Returns x, followed by the feature
    /// map after every layer; the last one is the middle block's input.
    std::vector<at::Tensor> descend(at::Tensor x, const at::Tensor& time, const at::Tensor& context,
                                    AttentionMaps* attention_maps = nullptr);
    at::Tensor run_middle(at::Tensor x, const at::Tensor& time, const at::Tensor& context,
                          AttentionMaps* maps = nullptr);
    at::ScalarType dtype() const { return conv_in_->weight.scalar_type(); }

  private:
    void make_down_blocks();
    void make_mid_block();

    UNetEncoderConfig encoder_config_;
    torch::nn::Conv2d conv_in_{nullptr};
    torch::nn::Linear time_linear_1_{nullptr}, time_linear_2_{nullptr};
    torch::nn::Linear add_linear_1_{nullptr}, add_linear_2_{nullptr};
    std::vector<UNetLevel> down_;
    UNetLevel mid_;
};

}  // namespace item3d
