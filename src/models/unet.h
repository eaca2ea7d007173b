// UNet2DConditionModel of diffusers: the noise predictor of Stable Diffusion 1, 2 and XL.
#pragma once

#include "item3d/models/config.h"
#include "item3d/models/unet_blocks.h"

#include <torch/types.h>

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// The keys of unet/config.json that this implementation honours; other keys must have their
/// usual values, or from_config throws.
struct UNet2DConditionConfig {
    int sample_size = 64;  ///< latent cells a side that the model was trained on
    int in_channels = 4;
    int out_channels = 4;
    std::vector<int> block_out_channels{320, 640, 1280, 1280};
    std::vector<std::string> down_block_types{"CrossAttnDownBlock2D", "CrossAttnDownBlock2D",
                                              "CrossAttnDownBlock2D", "DownBlock2D"};
    std::vector<std::string> up_block_types{"UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D",
                                            "CrossAttnUpBlock2D"};
    std::vector<int> layers_per_block{2, 2, 2, 2};
    /// NUMBER of heads of each down block, whatever the key is called.
    std::vector<int> attention_head_dim{8, 8, 8, 8};
    std::vector<int> transformer_layers_per_block{1, 1, 1, 1};
    std::vector<int> cross_attention_dim{768, 768, 768, 768};  ///< width of the text, a block
    int norm_num_groups = 32;
    double norm_eps = 1e-5;
    bool use_linear_projection = false;
    bool flip_sin_to_cos = true;
    double freq_shift = 0;
    bool center_input_sample = false;
    int downsample_padding = 1;
    double mid_block_scale_factor = 1;
    /// "" or "text_time" (SDXL: pooled text and picture sizes are added to the time embedding).
    std::string addition_embed_type;
    int addition_time_embed_dim = 0;
    int projection_class_embeddings_input_dim = 0;

    /// Throws InputError that names the key for what is missing, inconsistent or unsupported.
    static UNet2DConditionConfig from_config(const Config& config);
    static UNet2DConditionConfig from_json(const nlohmann::json& json,
                                           const std::string& subject = "unet/config.json");
    /// A config.json that diffusers can read.
    nlohmann::json to_json() const;
    int blocks() const { return static_cast<int>(block_out_channels.size()); }
    /// A lower bound of the number of parameters.
    double least_parameters() const;
};

/// SDXL's second condition; left empty for other models.
struct AddedCondition {
    torch::Tensor text_embeds;  ///< [N, P] pooled text
    torch::Tensor time_ids;     ///< [N, 6] original size, crop corner, target size
};

/// [N] timesteps of any type -> [N, channels] float32 sinusoids (Vaswani et al. 2017).
torch::Tensor sinusoidal_embedding(const torch::Tensor& timesteps, int channels,
                                   bool flip_sin_to_cos, double freq_shift);

class UNet2DConditionImpl : public torch::nn::Module {
  public:
    explicit UNet2DConditionImpl(const UNet2DConditionConfig& config);

    /// sample [N, in_channels, H, W] (any H and W); timesteps [N] or one, integers or not;
    /// encoder_hidden_states [N, S, cross_attention_dim] -> [N, out_channels, H, W] of the weights'
    /// type (under autocast: what that gives). Inputs are converted to the weights' type.
    torch::Tensor forward(const torch::Tensor& sample, const torch::Tensor& timesteps,
                          const torch::Tensor& encoder_hidden_states,
                          const AddedCondition& added = {});

    /// The two stages of the time embedding, [N, block_out_channels[0]] and [N, 4 x that].
    torch::Tensor time_sinusoids(const torch::Tensor& timesteps) const;
    torch::Tensor time_embedding(const torch::Tensor& sinusoids);

    const UNet2DConditionConfig& config() const { return config_; }

  private:
    /// One level of the down or the up path.
    struct Level {
        std::vector<ResnetBlock> resnets;
        std::vector<SpatialTransformer> attentions;
        Downsample down{nullptr};
        Upsample up{nullptr};
    };
    void make_down_blocks();
    void make_mid_block();
    void make_up_blocks();

    UNet2DConditionConfig config_;
    int time_channels_;
    torch::nn::Conv2d conv_in_{nullptr}, conv_out_{nullptr};
    torch::nn::GroupNorm conv_norm_out_{nullptr};
    torch::nn::Linear time_linear_1_{nullptr}, time_linear_2_{nullptr};
    torch::nn::Linear add_linear_1_{nullptr}, add_linear_2_{nullptr};
    std::vector<Level> down_;
    Level mid_;
    std::vector<Level> up_;
};
TORCH_MODULE(UNet2DCondition);

/// Reads FOLDER/config.json and FOLDER/diffusion_pytorch_model.* . Throws InputError.
UNet2DCondition load_unet(const std::filesystem::path& folder, torch::Device device = torch::kCPU,
                          torch::Dtype dtype = torch::kFloat32);

}  // namespace item3d
