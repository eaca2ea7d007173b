// CLIPSeg (Lüddecke and Ecker 2022): segmentation of an image by a sentence, in transformers'
// CLIPSegForImageSegmentation layout.
#pragma once

#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>

#include <filesystem>
#include <vector>

namespace item3d {

struct ClipSegConfig {
    ClipConfig clip;
    /// Layers of the vision transformer, numbered from 0, whose outputs the decoder reads. It reads
    /// the last one first.
    std::vector<int> extract_layers{3, 6, 9};
    int reduce_dim = 64;                  ///< width of the decoder
    int decoder_num_attention_heads = 4;  ///< divides reduce_dim
    int decoder_intermediate_size = 2048;
    int conditional_layer = 0;  ///< decoder layer whose input depends on the sentence
    /// True if three convolutions instead of one make the mask ("refined").
    bool use_complex_transposed_convolution = false;

    /// Throws InputError, also for a config of another class.
    static ClipSegConfig from_config(const Config& config);
    nlohmann::json to_json() const;
    /// Returns the mask's edge for an image with the edge `image`, both in pixels. Both are
    /// equal, except for refined masks with a patch size other than 16.
    int mask_size(int image) const;
    double min_parameters() const;
};

/// Post-norm transformer layer. Its parameters have transformers' names.
class ClipSegLayerImpl : public torch::nn::Module {
  public:
    ClipSegLayerImpl(int width, int intermediate, int heads, double epsilon);
    at::Tensor forward(const at::Tensor& x);  ///< [N, S, width] -> the same shape

  private:
    int heads_;
    PackableLinear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
    PackableLinear feed_in_{nullptr}, feed_out_{nullptr};
    torch::nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
};
TORCH_MODULE(ClipSegLayer);

class ClipSegDecoderImpl : public torch::nn::Module {
  public:
    explicit ClipSegDecoderImpl(const ClipSegConfig& config);
    /// activations: outputs [N, 1 + rows * columns, D] of the layers extract_layers, in their
    /// order. embeddings: text features of P prompts, [N, P, E], or [P, E] if they are the same for
    /// all images. Returns logits [N, P, h, w].
    at::Tensor forward(const std::vector<at::Tensor>& activations, const at::Tensor& embeddings,
                       std::int64_t rows, std::int64_t columns);

  private:
    at::Tensor upscale(const at::Tensor& x);  ///< [M, reduce_dim, rows, columns] -> [M, 1, h, w]

    ClipSegConfig config_;
    torch::nn::Linear film_mul_{nullptr}, film_add_{nullptr};
    std::vector<torch::nn::Linear> reduces_;
    std::vector<ClipSegLayer> layers_;
    torch::nn::Conv2d smooth_{nullptr};  ///< for refined masks only
    std::vector<torch::nn::ConvTranspose2d> upscalers_;
};
TORCH_MODULE(ClipSegDecoder);

class ClipSegModelImpl : public torch::nn::Module {
  public:
    explicit ClipSegModelImpl(const ClipSegConfig& config);

    /// Returns text features [P, projection_dim] of P prompts, not normalised. Inputs are as for
    /// ClipTextModel.
    at::Tensor conditional_embeddings(const at::Tensor& input_ids,
                                      const at::Tensor& attention_mask = {});
    /// pixel_values are [N, 3, H, W], where H and W are multiples of the patch size. embeddings are
    /// [P, projection_dim] or [N, P, projection_dim]. Returns logits [N, P, h, w]. Differentiable.
    at::Tensor forward(const at::Tensor& pixel_values, const at::Tensor& embeddings);
    /// Returns the outputs of the layers config().extract_layers, [N, S, D] each.
    std::vector<at::Tensor> activations(const at::Tensor& pixel_values);

    const ClipSegConfig& config() const { return config_; }

  private:
    ClipSegConfig config_;
    ClipModel clip_{nullptr};
    ClipSegDecoder decoder_{nullptr};
};
TORCH_MODULE(ClipSegModel);

/// Reads FOLDER/config.json and FOLDER/model.*. Throws InputError.
ClipSegModel load_clip_seg(const std::filesystem::path& folder, at::Device device = at::kCPU,
                           at::ScalarType dtype = at::kFloat);

/// Writes FOLDER/config.json and FOLDER/model.safetensors.
void save_clip_seg(const std::filesystem::path& folder, const ClipSegModel& model,
                   at::ScalarType dtype = at::kHalf);

}  // namespace item3d
