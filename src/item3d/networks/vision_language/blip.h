// BLIP's captioning network (Li et al. 2022) in the layout of transformers'
// BlipForConditionalGeneration: a vision transformer, and a BERT decoder with cross-attention to
// its tokens.
#pragma once

#include "item3d/networks/layers/bert_layer.h"
#include "item3d/networks/vision_language/blip_vision.h"
#include "item3d/networks/vision_language/decoding.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace item3d {

struct BlipConfig {
    BlipVisionConfig vision;
    int vocab_size = 30524;
    int hidden_size = 768;
    int intermediate_size = 3072;
    int num_hidden_layers = 12;
    int num_attention_heads = 12;  ///< "num_attention_heads" of text_config
    int max_position_embeddings = 512;
    double layer_norm_eps = 1e-12;
    int bos_token_id = 30522;
    int sep_token_id = 102;  ///< token that ends a caption
    int pad_token_id = 0;

    static BlipConfig from_config(const Config& config);
    nlohmann::json to_json() const;
    double min_parameters() const;
};

class BlipModelImpl : public torch::nn::Module {
  public:
    explicit BlipModelImpl(const BlipConfig& config);

    /// Encodes pixel_values [N, 3, image_size, image_size] to T image tokens of width D, [N, T, D].
    at::Tensor image_embeds(const at::Tensor& pixel_values) { return vision_(pixel_values); }
    /// Returns the keys and values of each decoder layer's cross-attention.
    std::vector<KeyValues> read_image(const at::Tensor& image_embeds);

    /// Returns the decoder's states [N, S, D] of tokens [N, S] that follow those in `cache`, which
    /// may be null. visible [N, length] is 0 for padding, where length counts the tokens in `cache`
    /// too. image is the result of read_image() for M images, where M is a divisor of N (see
    /// BertLayer).
    at::Tensor decode(const at::Tensor& tokens, const at::Tensor& visible,
                      const std::vector<KeyValues>& image, KeyValueCache* cache = nullptr);
    /// Converts states to logits of the next token [N, S, vocab_size].
    at::Tensor logits(const at::Tensor& states);

    /// Makes a float32 network inference-only: its linear layers then multiply at this precision
    /// (packable_linear.h).
    void pack(at::ScalarType dtype);

    const BlipConfig& config() const { return config_; }

  private:
    BlipConfig config_;
    BlipVisionModel vision_{nullptr};
    torch::nn::Embedding words_{nullptr}, positions_{nullptr};
    torch::nn::LayerNorm embedding_norm_{nullptr}, head_norm_{nullptr};
    std::vector<BertLayer> layers_;
    PackableLinear head_{nullptr};
    at::Tensor head_bias_;
    std::optional<PackedMatrix> packed_words_;  ///< packed word embeddings, for logits()
};
TORCH_MODULE(BlipModel);

/// Reads FOLDER/config.json and FOLDER/model.*, with or without the tied head's tensors. Throws
/// InputError.
BlipModel load_blip(const std::filesystem::path& folder, at::Device device = at::kCPU,
                    at::ScalarType dtype = at::kFloat);

/// Writes FOLDER/config.json and FOLDER/model.safetensors, without the tied head's tensors.
void save_blip(const std::filesystem::path& folder, const BlipModel& model,
               at::ScalarType dtype = at::kHalf);

/// Captions N images. prompt [N or 1, S] int64 is the beginning of the captions, with bos_token_id
/// first. Of `options`, beams, max_new_tokens and length_penalty are used; the end and padding
/// tokens are the network's own. Throws InputError if prompt and caption exceed the network's
/// positions.
Decoded write_captions(const BlipModel& model, const at::Tensor& pixel_values,
                       const at::Tensor& prompt, DecodingOptions options);

}  // namespace item3d
