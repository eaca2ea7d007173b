// BLIP-2 with OPT (Li et al. 2023) in the layout of transformers' Blip2ForConditionalGeneration: a
// vision transformer, a Q-Former that reduces its tokens to a few, and a language model that reads
// these before its prompt.
#pragma once

#include "item3d/networks/layers/bert_layer.h"
#include "item3d/networks/vision_language/blip_vision.h"
#include "item3d/networks/vision_language/decoding.h"
#include "item3d/networks/vision_language/opt.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace item3d {

struct QFormerConfig {
    int hidden_size = 768;
    int intermediate_size = 3072;
    int num_hidden_layers = 12;
    int num_attention_heads = 12;
    int cross_attention_frequency = 2;  ///< f, where layers 0, f, 2f, ... attend to the image
    double layer_norm_eps = 1e-12;
};

struct Blip2Config {
    BlipVisionConfig vision;
    QFormerConfig qformer;
    OptConfig text;
    int num_query_tokens = 32;
    int image_token_index = 50265;  ///< placeholder token of the image in prompts

    static Blip2Config from_config(const Config& config);
    double min_parameters() const;
};

class Blip2ModelImpl : public torch::nn::Module {
  public:
    explicit Blip2ModelImpl(const Blip2Config& config);

    /// Encodes pixel_values [N, 3, image_size, image_size] to T image tokens of width D, [N, T, D].
    at::Tensor image_embeds(const at::Tensor& pixel_values) { return vision_(pixel_values); }
    /// Reduces image tokens to the Q-Former's output [N, Q, D'], where Q is num_query_tokens.
    at::Tensor query_image(const at::Tensor& image_embeds);
    /// Projects the Q-Former's output to embeddings of the language model [N, Q, D''].
    at::Tensor project(const at::Tensor& queried) { return projection_(queried); }
    /// Returns the embeddings of ids [N, S]. Each sequence contains image_token_index Q times;
    /// these positions get the image's embeddings [N, Q, D''].
    at::Tensor embed(const at::Tensor& ids, const at::Tensor& image);

    OptModel language_model() const { return language_model_; }
    const Blip2Config& config() const { return config_; }

  private:
    Blip2Config config_;
    BlipVisionModel vision_{nullptr};
    at::Tensor query_tokens_;
    torch::nn::LayerNorm query_norm_{nullptr};
    std::vector<BertLayer> query_layers_;
    torch::nn::Linear projection_{nullptr};
    OptModel language_model_{nullptr};
};
TORCH_MODULE(Blip2Model);

/// Reads FOLDER/config.json and FOLDER/model.*, with or without the tied head. Throws InputError.
Blip2Model load_blip2(const std::filesystem::path& folder, at::Device device = at::kCPU,
                      at::ScalarType dtype = at::kFloat);

/// Captions images as write_captions of blip.h does. prompt [N or 1, S] int64 consists of Q times
/// image_token_index, bos_token_id, and the text. visible has the same shape and is 0 for padding,
/// which is on the left; it is undefined if there is no padding. The end token is that of
/// `options`, because the token that published models use is not the one in their config.
Decoded write_captions(const Blip2Model& model, const at::Tensor& pixel_values,
                       const at::Tensor& prompt, const at::Tensor& visible,
                       DecodingOptions options);

}  // namespace item3d
