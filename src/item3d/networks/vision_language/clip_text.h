// CLIP's text encoder (Radford et al. 2021) in the layout of transformers' CLIPTextModel.
#pragma once

#include "item3d/core/config.h"
#include "item3d/networks/layers/clip_layer.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/container/modulelist.h>
#include <torch/nn/modules/embedding.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct ClipTextConfig {
    int vocab_size = 49408;
    int hidden_size = 512;
    int intermediate_size = 2048;
    int num_hidden_layers = 12;
    int num_attention_heads = 8;
    int max_position_embeddings = 77;
    std::string hidden_act = "quick_gelu";  ///< or "gelu"
    double layer_norm_eps = 1e-5;
    int bos_token_id = 49406;
    /// Id of the token that ends a text. Old configs have 2 here; the end of a text is then its
    /// largest id.
    int eos_token_id = 49407;
    int pad_token_id = 1;
    int projection_dim = 512;
    bool with_projection = false;  ///< CLIPTextModelWithProjection

    static ClipTextConfig from_config(const Config& config);
    static ClipTextConfig from_json(const nlohmann::json& json,
                                    const std::string& subject = "text_encoder/config.json");
    nlohmann::json to_json() const;
    double min_parameters() const;
};

/// Output tensors; each is [N, S, D] unless stated.
struct ClipTextOutput {
    at::Tensor last_hidden_state;  ///< after the final layer norm
    /// Embeddings, then each layer's output, before the final layer norm.
    std::vector<at::Tensor> hidden_states;
    at::Tensor pooled;       ///< [N, D] last_hidden_state at the end-of-text token
    at::Tensor text_embeds;  ///< [N, projection_dim], only with a projection
};

class ClipTextModelImpl : public torch::nn::Module {
  public:
    explicit ClipTextModelImpl(const ClipTextConfig& config);

    /// input_ids [N, S] are integers, and S <= max_position_embeddings. attention_mask [N, S] is 1
    /// for tokens to read, else 0. If it is empty, all tokens are read, including padding, as
    /// diffusers does.
    ClipTextOutput forward(const at::Tensor& input_ids, const at::Tensor& attention_mask = {});

    /// Returns the states of diffusers' clip_skip = `skip` (0 means the last hidden state).
    at::Tensor skip_layers(const ClipTextOutput& output, int skip);

    /// Sets the embeddings of the tokens from `first_id` on to `rows`, [count, hidden_size]. The
    /// table grows if needed.
    void set_token_embeddings(std::int64_t first_id, const at::Tensor& rows);

    const ClipTextConfig& config() const { return config_; }

  private:
    ClipTextConfig config_;
    torch::nn::Embedding token_embedding_{nullptr}, position_embedding_{nullptr};
    std::vector<ClipLayer> layers_;
    torch::nn::LayerNorm final_layer_norm_{nullptr};
    torch::nn::Linear text_projection_{nullptr};
};
TORCH_MODULE(ClipTextModel);

/// Reads FOLDER/config.json and FOLDER/model.*, with or without the name prefix "text_model.".
/// Throws InputError.
ClipTextModel load_clip_text(const std::filesystem::path& folder, at::Device device = at::kCPU,
                             at::ScalarType dtype = at::kFloat);

/// Returns parameters under their published names (prefix "text_model." except for the projection).
std::vector<std::pair<std::string, at::Tensor>> published_tensors(
    const ClipTextModel& model, at::ScalarType dtype = at::kFloat);

}  // namespace item3d
