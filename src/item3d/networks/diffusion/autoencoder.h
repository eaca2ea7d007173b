// The autoencoders between pictures and latents: diffusers' AutoencoderKL and AutoencoderTiny.
#pragma once

#include "item3d/core/config.h"
#include "item3d/tensors/weights.h"

#include <torch/nn/modules/container/modulelist.h>
#include <torch/nn/modules/conv.h>
#include <torch/types.h>

#include <filesystem>
#include <memory>
#include <vector>

namespace item3d {

/// What a pipeline needs of either kind. A torch module: its parameters have diffusers' names.
class Autoencoder : public torch::nn::Module {
  public:
    /// images [N, 3, H, W] in [-1, 1] -> latents [N, latent_channels, h, w], not scaled; the mean
    /// where the encoder gives a distribution.
    virtual torch::Tensor encode(const torch::Tensor& images) = 0;
    /// Unscaled latents -> images [N, 3, H, W], about [-1, 1], not clamped.
    virtual torch::Tensor decode(const torch::Tensor& latents) = 0;

    /// While on, a gradient through encode() takes less memory and more time, where the network is
    /// large enough for that to matter.
    virtual void recompute_in_backward(bool on) { (void)on; }

    /// The U-Net sees (latent - shift_factor) * scaling_factor.
    virtual double scaling_factor() const = 0;
    virtual double shift_factor() const = 0;
    virtual int latent_channels() const = 0;
    /// Image pixels a latent cell, along one side.
    virtual int downscale() const = 0;
    /// A config.json that diffusers can read.
    virtual nlohmann::json config_json() const = 0;
};

struct AutoencoderTinyConfig {
    int in_channels = 3;
    int out_channels = 3;
    int latent_channels = 4;
    std::vector<int> encoder_block_out_channels{64, 64, 64, 64};
    std::vector<int> decoder_block_out_channels{64, 64, 64, 64};
    std::vector<int> num_encoder_blocks{1, 3, 3, 3};
    std::vector<int> num_decoder_blocks{3, 3, 3, 1};
    double scaling_factor = 1.0;
    double shift_factor = 0.0;

    static AutoencoderTinyConfig from_config(const Config& config);
    nlohmann::json to_json() const;
    double least_parameters() const;
};

/// TAESD (Bohan 2023): ReLU residual blocks, no norms, deterministic latents.
class AutoencoderTiny : public Autoencoder {
  public:
    explicit AutoencoderTiny(const AutoencoderTinyConfig& config);
    ~AutoencoderTiny() override;
    torch::Tensor encode(const torch::Tensor& images) override;
    torch::Tensor decode(const torch::Tensor& latents) override;
    double scaling_factor() const override { return config_.scaling_factor; }
    double shift_factor() const override { return config_.shift_factor; }
    int latent_channels() const override { return config_.latent_channels; }
    int downscale() const override;
    nlohmann::json config_json() const override { return config_.to_json(); }

    /// Training measures the latents' spread at its end and sets the factor that makes it 1.
    void set_scaling_factor(double factor) { config_.scaling_factor = factor; }
    const AutoencoderTinyConfig& config() const { return config_; }

  private:
    class Block;  // residual block
    struct Layer;
    void add(torch::nn::ModuleList& list, std::vector<Layer>& layers, Layer layer);
    static torch::Tensor run(const std::vector<Layer>& layers, torch::Tensor x);

    AutoencoderTinyConfig config_;
    std::vector<Layer> encoder_, decoder_;
};

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
    double least_parameters() const;
};

/// A diagonal Gaussian over latents, each [N, C, h, w].
struct LatentDistribution {
    torch::Tensor mean;
    torch::Tensor log_variance;  ///< clamped to [-30, 20]
    torch::Tensor deviation() const { return torch::exp(0.5 * log_variance); }
};

/// Stable Diffusion's autoencoder (Rombach et al. 2022).
class AutoencoderKL : public Autoencoder {
  public:
    /// Without a decoder it cannot decode() and has none of the decoder's parameters.
    explicit AutoencoderKL(const AutoencoderKLConfig& config, bool with_decoder = true);
    LatentDistribution encode_distribution(const torch::Tensor& images);
    torch::Tensor encode(const torch::Tensor& images) override;
    torch::Tensor decode(const torch::Tensor& latents) override;
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

/// Reads FOLDER/config.json (its _class_name decides the kind) and
/// FOLDER/diffusion_pytorch_model.*; old spellings of the attention's names are understood. Without
/// a decoder, an AutoencoderKL's is not read and takes no memory. Throws InputError.
std::shared_ptr<Autoencoder> load_autoencoder(const std::filesystem::path& folder,
                                              torch::Device device = torch::kCPU,
                                              torch::Dtype dtype = torch::kFloat32,
                                              bool with_decoder = true,
                                              WeightUse use = WeightUse::any);

}  // namespace item3d
