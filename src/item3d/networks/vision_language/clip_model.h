// CLIP whole (Radford et al. 2021): how well a picture and a sentence go together. transformers'
// CLIPModel layout.
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
    nlohmann::json to_json() const;
};

class ClipModelImpl : public torch::nn::Module {
  public:
    explicit ClipModelImpl(const ClipConfig& config);

    /// pixel_values [N, 3, S, S] -> [N, projection_dim], not normalised; differentiable.
    at::Tensor image_features(const at::Tensor& pixel_values);
    /// As ClipTextModel takes them -> [N, projection_dim], not normalised.
    at::Tensor text_features(const at::Tensor& input_ids, const at::Tensor& attention_mask = {});
    /// What both are multiplied with in logits: logits = scale * cosine. A scalar.
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

/// The model with all that pictures and sentences need on their way to it.
class Clip {
  public:
    /// Reads FOLDER (config.json, model.*, preprocessor_config.json, vocab.json, merges.txt, ...).
    /// Throws InputError naming the file for anything missing or unsupported.
    static Clip load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                     at::ScalarType dtype = at::kFloat);

    /// The same for many pictures: linear layers are packed (packable_linear.h) where the processor
    /// gains by it, and those alone compute in `dtype` then.
    static Clip load_to_run(const std::filesystem::path& folder, at::Device device,
                            at::ScalarType dtype);

    /// Warns where embed_texts() leaves out the end of a text because it is too long.
    void warn_of_lost_words(const std::string& subject, const std::string& text) const;
    /// [N, D] float32, each of length 1.
    at::Tensor embed_texts(const std::vector<std::string>& texts) const;
    /// images [N, 3, H, W] sRGB in [0, 1] -> [N, D] float32, each of length 1. Differentiable in
    /// the images.
    at::Tensor embed_images(const at::Tensor& images) const;

    ClipModel model{nullptr};
    std::shared_ptr<ClipTokenizer> tokenizer;
    std::shared_ptr<ImageProcessor> processor;

  private:
    int text_length() const;  ///< tokens that the network reads

    at::Device device_ = at::kCPU;
};

}  // namespace item3d
