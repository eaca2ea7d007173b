// CLIP's image encoder (Radford et al. 2021) in the layout of transformers'
// CLIPVisionModelWithProjection: a vision transformer (Dosovitskiy et al. 2021) whose class token
// becomes the image's feature.
#pragma once

#include "item3d/networks/layers/clip_layer.h"
#include "item3d/networks/vision_language/vision_shape.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/embedding.h>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct ClipVisionConfig : VisionShape {
    int num_channels = 3;
    std::string hidden_act = "quick_gelu";  ///< or "gelu"
    int projection_dim = 512;

    static ClipVisionConfig from_config(const Config& config);
    nlohmann::json to_json() const;
};

/// Output of the encoder, where S is tokens() and D is hidden_size.
struct ClipVisionOutput {
    at::Tensor last_hidden_state;  ///< [N, S, D], before the final layer norm
    /// Input of the first layer, then each layer's output, [N, S, D] each.
    std::vector<at::Tensor> hidden_states;
    at::Tensor pooled;  ///< [N, D], the class token after the final layer norm
};

class ClipVisionModelImpl : public torch::nn::Module {
  public:
    explicit ClipVisionModelImpl(const ClipVisionConfig& config);
    /// pixel_values are [N, 3, image_size, image_size], as ImageProcessor makes them.
    /// Differentiable.
    ClipVisionOutput forward(const at::Tensor& pixel_values);
    /// Returns only the `pooled` of forward(), which needs only one token of the last layer.
    at::Tensor pooled(const at::Tensor& pixel_values);
    /// Returns the outputs of the first `count` layers, [N, S, D] each. pixel_values [N, 3, H, W]
    /// may have any size: positions are interpolated as in transformers' CLIPSeg, and S is 1 + the
    /// number of patches.
    std::vector<at::Tensor> first_layers(const at::Tensor& pixel_values, int count);
    const ClipVisionConfig& config() const { return config_; }

  private:
    /// Returns the input of the first layer, [N, S, D].
    at::Tensor embed(const at::Tensor& pixel_values);
    void check_size(const at::Tensor& pixel_values) const;
    at::Tensor positions(std::int64_t rows, std::int64_t columns) const;  ///< [S, D]

    ClipVisionConfig config_;
    at::Tensor class_embedding_;
    torch::nn::Conv2d patch_embedding_{nullptr};
    torch::nn::Embedding position_embedding_{nullptr};
    torch::nn::LayerNorm pre_norm_{nullptr}, post_norm_{nullptr};
    std::vector<ClipLayer> layers_;
};
TORCH_MODULE(ClipVisionModel);

/// Image encoder with the projection into the space shared by images and texts.
class ClipVisionWithProjectionImpl : public torch::nn::Module {
  public:
    explicit ClipVisionWithProjectionImpl(const ClipVisionConfig& config);
    ClipVisionOutput forward(const at::Tensor& pixel_values) { return vision_(pixel_values); }
    /// Returns the projected feature [N, projection_dim], not normalised.
    at::Tensor project(const ClipVisionOutput& output) { return projection_(output.pooled); }

  private:
    ClipVisionModel vision_{nullptr};
    torch::nn::Linear projection_{nullptr};
};
TORCH_MODULE(ClipVisionWithProjection);

/// Reads FOLDER/config.json and FOLDER/model.*. Throws InputError.
ClipVisionWithProjection load_clip_vision(const std::filesystem::path& folder,
                                          at::Device device = at::kCPU,
                                          at::ScalarType dtype = at::kFloat);

}  // namespace item3d
