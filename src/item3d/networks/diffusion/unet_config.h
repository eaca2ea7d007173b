// Configuration of diffusers' U-Net and of its encoder, which a ControlNet has too.
#pragma once

#include "item3d/core/config.h"

#include <string>
#include <vector>

namespace item3d {

/// Supported keys of the down path and the middle block; other keys must have their usual values.
struct UNetEncoderConfig {
    int in_channels = 4;
    std::vector<int> block_out_channels{320, 640, 1280, 1280};
    std::vector<std::string> down_block_types{"CrossAttnDownBlock2D", "CrossAttnDownBlock2D",
                                              "CrossAttnDownBlock2D", "DownBlock2D"};
    std::vector<int> layers_per_block{2, 2, 2, 2};
    /// NUMBER of heads of each down block, despite the key's name.
    std::vector<int> attention_head_dim{8, 8, 8, 8};
    std::vector<int> transformer_layers_per_block{1, 1, 1, 1};
    /// Width of the text embedding, for each block.
    std::vector<int> cross_attention_dim{768, 768, 768, 768};
    int norm_num_groups = 32;
    double norm_eps = 1e-5;
    bool use_linear_projection = false;
    bool flip_sin_to_cos = true;
    double freq_shift = 0;
    int downsample_padding = 1;
    double mid_block_scale_factor = 1;
    /// "" or "text_time" (SDXL: pooled text and image sizes are added to the time embedding).
    std::string addition_embed_type;
    int addition_time_embed_dim = 0;
    int projection_class_embeddings_input_dim = 0;

    /// Throws InputError that names the key for missing, inconsistent or unsupported values.
    void read(const Config& config);
    int blocks() const { return static_cast<int>(block_out_channels.size()); }
    int time_channels() const { return 4 * block_out_channels[0]; }
    /// Returns a lower bound of the number of parameters.
    double min_parameters() const;
};

/// Configuration of the whole U-Net.
struct UNet2DConditionConfig : UNetEncoderConfig {
    int sample_size = 64;  ///< latent cells along one side of the training images
    int out_channels = 4;
    std::vector<std::string> up_block_types{"UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D",
                                            "CrossAttnUpBlock2D"};
    bool center_input_sample = false;

    /// Throws InputError like UNetEncoderConfig::read.
    static UNet2DConditionConfig from_config(const Config& config);
    static UNet2DConditionConfig from_json(const nlohmann::json& json,
                                           const std::string& subject = "unet/config.json");
    /// Returns a config.json that diffusers can read.
    nlohmann::json to_json() const;
};

}  // namespace item3d
