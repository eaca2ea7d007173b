// UNet2DConditionModel of diffusers: the noise predictor of Stable Diffusion 1, 2 and XL.
#pragma once

#include "item3d/core/config.h"
#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/diffusion/unet_config.h"
#include "item3d/networks/diffusion/unet_encoder.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Residuals that a ControlNet adds to a U-Net of the same blocks.
struct UNetResiduals {
    std::vector<at::Tensor> down;  ///< one for each feature map of the down path, conv_in's first
    at::Tensor mid;                ///< for the output of the middle block
};

class UNet2DConditionImpl : public UNetEncoderImpl {
  public:
    explicit UNet2DConditionImpl(const UNet2DConditionConfig& config);

    /// sample is [N, in_channels, H, W] with any H and W. timesteps are [N] or one, integers or
    /// not. encoder_hidden_states is [N, S, cross_attention_dim]. Returns [N, out_channels, H, W]
    /// of the weights' type, or of autocast's type under autocast. Inputs are converted to the
    /// weights' type. maps, unless null, accumulates the cross-attention of all layers.
    at::Tensor forward(const at::Tensor& sample, const at::Tensor& timesteps,
                       const at::Tensor& encoder_hidden_states, const AddedCondition& added = {},
                       const UNetResiduals& residuals = {}, AttentionMaps* maps = nullptr);

    const UNet2DConditionConfig& config() const { return config_; }

  private:
    void make_up_blocks();

    UNet2DConditionConfig config_;
    torch::nn::Conv2d conv_out_{nullptr};
    torch::nn::GroupNorm conv_norm_out_{nullptr};
    std::vector<UNetLevel> up_;
};
TORCH_MODULE(UNet2DCondition);

/// Reads FOLDER/config.json and FOLDER/diffusion_pytorch_model.* . Throws InputError.
UNet2DCondition load_unet(const std::filesystem::path& folder, at::Device device = at::kCPU,
                          at::ScalarType dtype = at::kFloat, WeightUse use = WeightUse::any);

}  // namespace item3d
