// Vision transformer of BLIP (Li et al. 2022) and BLIP-2 (Li et al. 2023), in the layout of
// transformers' BlipVisionModel and Blip2VisionModel.
#pragma once

#include "item3d/networks/vision_language/vision_shape.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/module.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/normalization.h>

#include <memory>
#include <vector>

namespace item3d {

struct BlipVisionConfig : VisionShape {
    BlipVisionConfig() : VisionShape{.image_size = 384, .patch_size = 16} {}

    /// Reads a config; missing keys keep the values of `defaults`. Throws InputError.
    static BlipVisionConfig from_config(const Config& config, const BlipVisionConfig& defaults);
    nlohmann::json to_json() const;
};

class BlipVisionModelImpl : public torch::nn::Module {
  public:
    explicit BlipVisionModelImpl(const BlipVisionConfig& config);
    /// Encodes pixel_values [N, 3, image_size, image_size] to [N, tokens(), hidden_size], after the
    /// final layer norm.
    at::Tensor forward(const at::Tensor& pixel_values);

  private:
    class Layer;
    BlipVisionConfig config_;
    at::Tensor class_embedding_, position_embedding_;
    torch::nn::Conv2d patch_embedding_{nullptr};
    torch::nn::LayerNorm post_norm_{nullptr};
    std::vector<std::shared_ptr<Layer>> layers_;
};
TORCH_MODULE(BlipVisionModel);

}  // namespace item3d
