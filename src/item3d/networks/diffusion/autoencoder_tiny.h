// AutoencoderTiny of diffusers: a small autoencoder without norms.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"

#include <torch/nn/modules/container/modulelist.h>

#include <vector>

namespace item3d {

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
    double min_parameters() const;
};

/// TAESD (Bohan 2023): ReLU residual blocks, no norms, deterministic latents.
class AutoencoderTiny : public Autoencoder {
  public:
    explicit AutoencoderTiny(const AutoencoderTinyConfig& config);
    ~AutoencoderTiny() override;
    at::Tensor encode(const at::Tensor& images) override;
    at::Tensor decode(const at::Tensor& latents) override;
    double scaling_factor() const override { return config_.scaling_factor; }
    double shift_factor() const override { return config_.shift_factor; }
    int latent_channels() const override { return config_.latent_channels; }
    int downscale() const override;
    nlohmann::json config_json() const override { return config_.to_json(); }

    /// Sets the factor that scales latents to a standard deviation of 1, measured at the end of
    /// training.
    void set_scaling_factor(double factor) { config_.scaling_factor = factor; }
    const AutoencoderTinyConfig& config() const { return config_; }

  private:
    class Block;  // residual block
    struct Layer;
    void add(torch::nn::ModuleList& list, std::vector<Layer>& layers, Layer layer);
    static at::Tensor run(const std::vector<Layer>& layers, at::Tensor x);

    AutoencoderTinyConfig config_;
    std::vector<Layer> encoder_, decoder_;
};

}  // namespace item3d
