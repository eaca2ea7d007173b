// OPT language model (Zhang et al. 2022) in the layout of transformers' OPTForCausalLM, with the
// layer norm before each block (as in all published sizes except 350M).
#pragma once

#include "item3d/core/config.h"
#include "item3d/networks/layers/key_value_cache.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/embedding.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>

#include <memory>
#include <vector>

namespace item3d {

struct OptConfig {
    int vocab_size = 50272;
    int hidden_size = 768;
    int ffn_dim = 3072;
    int num_hidden_layers = 12;
    int num_attention_heads = 12;
    int max_position_embeddings = 2048;
    int bos_token_id = 2;
    int eos_token_id = 2;
    int pad_token_id = 1;

    static OptConfig from_config(const Config& config);
    double min_parameters() const;
};

class OptModelImpl : public torch::nn::Module {
  public:
    explicit OptModelImpl(const OptConfig& config);

    /// Returns the embeddings [N, S, hidden_size] of ids [N, S].
    at::Tensor embed(const at::Tensor& ids) { return words_(ids); }
    /// Returns the states of embeddings [N, S, hidden_size], in the same shape. The embeddings
    /// follow the tokens in `cache`, which may be null. visible [N, length] int64 is 1, or 0 for
    /// padding; its length counts the tokens in `cache` too. No token sees padding, and padding
    /// takes no position.
    at::Tensor forward(const at::Tensor& embeddings, const at::Tensor& visible,
                       KeyValueCache* cache = nullptr);
    /// Converts states to logits of the next token [N, S, vocab_size].
    at::Tensor logits(const at::Tensor& states) const { return at::linear(states, words_->weight); }

    const OptConfig& config() const { return config_; }

  private:
    class Layer;
    OptConfig config_;
    torch::nn::Embedding words_{nullptr}, positions_{nullptr};
    std::vector<std::shared_ptr<Layer>> layers_;
    torch::nn::LayerNorm final_norm_{nullptr};
};
TORCH_MODULE(OptModel);

}  // namespace item3d
