// CLIP (Radford et al. 2021): the similarity of image and sentence, in transformers' CLIPModel
// layout.
#pragma once

#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/networks/vision_language/clip_vision.h"
#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct ClipConfig {
    ClipTextConfig text;
    ClipVisionConfig vision;
    int projection_dim = 512;

    static ClipConfig from_config(const Config& config);
    /// Reads the CLIP part of the config of another class.
    static ClipConfig from_parts(const Config& config);
    nlohmann::json to_json() const;
};

class ClipModelImpl : public torch::nn::Module {
  public:
    explicit ClipModelImpl(const ClipConfig& config);

    /// Returns the image features [N, projection_dim] of pixel_values [N, 3, image_size,
    /// image_size], not normalised. Differentiable.
    at::Tensor image_features(const at::Tensor& pixel_values);
    /// Returns text features [N, projection_dim], not normalised. Inputs are as for ClipTextModel.
    at::Tensor text_features(const at::Tensor& input_ids, const at::Tensor& attention_mask = {});
    /// Scale of the logits, a scalar: logits = scale * cosine.
    at::Tensor logit_scale() const { return logit_scale_.exp(); }

    ClipVisionModel vision() const { return vision_; }
    const ClipConfig& config() const { return config_; }

  private:
    ClipConfig config_;
    ClipTextModel text_{nullptr};
    ClipVisionModel vision_{nullptr};
    torch::nn::Linear text_projection_{nullptr}, visual_projection_{nullptr};
    at::Tensor logit_scale_;
};
TORCH_MODULE(ClipModel);

/// Reads FOLDER/config.json and FOLDER/model.*. Throws InputError.
ClipModel load_clip_model(const std::filesystem::path& folder, at::Device device = at::kCPU,
                          at::ScalarType dtype = at::kFloat);

/// Writes FOLDER/config.json and FOLDER/model.safetensors.
void save_clip_model(const std::filesystem::path& folder, const ClipModel& model,
                     at::ScalarType dtype = at::kHalf);

}  // namespace item3d
