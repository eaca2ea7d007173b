// ControlNetModel of diffusers (Zhang et al. 2023): a copy of the U-Net's encoder that reads a
// conditioning image and adds residuals to the U-Net's feature maps.
#pragma once

#include "item3d/networks/diffusion/unet.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace item3d {

struct ControlNetConfig : UNetEncoderConfig {
    int conditioning_channels = 3;
    /// Channels of the small network that converts the image to a feature map of the latents' size.
    /// Each step halves the size.
    std::vector<int> conditioning_embedding_out_channels{16, 32, 96, 256};
    bool reverse_channels = false;  ///< for networks trained on BGR images

    /// Throws InputError that names the key for missing, inconsistent or unsupported values.
    static ControlNetConfig from_config(const Config& config);
    /// Image pixels per latent cell, along one side.
    int downscale() const;
};

class ControlNetImpl : public UNetEncoderImpl {
  public:
    explicit ControlNetImpl(const ControlNetConfig& config);
    ~ControlNetImpl() override;

    /// sample, timesteps, encoder_hidden_states and added are as for the U-Net. image is [N,
    /// conditioning_channels, downscale() x H, downscale() x W] in [0, 1]. Returns residuals of the
    /// weights' type, multiplied by `scale`.
    UNetResiduals forward(const at::Tensor& sample, const at::Tensor& timesteps,
                          const at::Tensor& encoder_hidden_states, const at::Tensor& image,
                          double scale = 1, const AddedCondition& added = {});

    const ControlNetConfig& config() const { return config_; }

  private:
    class ImageEmbedding;
    void make_outputs();

    ControlNetConfig config_;
    std::shared_ptr<ImageEmbedding> image_embedding_;
    std::vector<torch::nn::Conv2d> down_outputs_;
    torch::nn::Conv2d mid_output_{nullptr};
};
TORCH_MODULE(ControlNet);

/// Reads FOLDER/config.json and FOLDER/diffusion_pytorch_model.* . Throws InputError.
ControlNet load_controlnet(const std::filesystem::path& folder, at::Device device = at::kCPU,
                           at::ScalarType dtype = at::kFloat);

}  // namespace item3d
