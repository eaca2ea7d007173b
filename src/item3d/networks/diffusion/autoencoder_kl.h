// AutoencoderKL of diffusers: Stable Diffusion's autoencoder.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"

#include <torch/nn/modules/conv.h>

#include <memory>
#include <vector>

namespace item3d {

struct AutoencoderKLConfig {
    int in_channels = 3;
    int out_channels = 3;
    int latent_channels = 4;
    std::vector<int> block_out_channels{128, 256, 512, 512};
    int layers_per_block = 2;
    int norm_num_groups = 32;
    bool mid_block_add_attention = true;
    bool use_quant_conv = true;
    bool use_post_quant_conv = true;
    double scaling_factor = 0.18215;
    double shift_factor = 0.0;
    int sample_size = 512;

    static AutoencoderKLConfig from_config(const Config& config);
    nlohmann::json to_json() const;
    double min_parameters() const;
};

/// A Gaussian over latents with a diagonal covariance. Each tensor is [N, C, h, w].
struct LatentDistribution {
    at::Tensor mean;
    at::Tensor log_variance;  ///< clamped to [-30, 20]
    at::Tensor deviation() const { return at::exp(0.5 * log_variance); }
};

/// Stable Diffusion's autoencoder (Rombach et al. 2022).
class AutoencoderKL : public Autoencoder {
  public:
    /// Without with_decoder, the module cannot decode() and lacks the decoder's parameters.
    explicit AutoencoderKL(const AutoencoderKLConfig& config, bool with_decoder = true);
    LatentDistribution encode_distribution(const at::Tensor& images);
    at::Tensor encode(const at::Tensor& images) override;
    at::Tensor decode(const at::Tensor& latents) override;
    void recompute_in_backward(bool on) override;
    double scaling_factor() const override { return config_.scaling_factor; }
    double shift_factor() const override { return config_.shift_factor; }
    int latent_channels() const override { return config_.latent_channels; }
    int downscale() const override;
    nlohmann::json config_json() const override { return config_.to_json(); }

  private:
    class PixelAttention;
    class MidBlock;
    class Encoder;
    class Decoder;
    AutoencoderKLConfig config_;
    std::shared_ptr<Encoder> encoder_;
    std::shared_ptr<Decoder> decoder_;
    torch::nn::Conv2d quant_conv_{nullptr}, post_quant_conv_{nullptr};
};

}  // namespace item3d
