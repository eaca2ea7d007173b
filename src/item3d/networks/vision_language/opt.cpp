#include "item3d/networks/vision_language/opt.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/attention.h"

#include <torch/nn/modules/container/modulelist.h>

namespace item3d {
namespace nn = torch::nn;
namespace {

/// Offset of the position table, whose first rows are not positions (a padding token has row 1).
constexpr int position_offset = 2;

}  // namespace

class OptModelImpl::Layer : public nn::Module {
  public:
    explicit Layer(const OptConfig& config) : heads_(config.num_attention_heads) {
        const int width = config.hidden_size;
        const auto norm = [&] { return nn::LayerNorm(nn::LayerNormOptions({width})); };
        auto attention = std::make_shared<nn::Module>("attention");
        query_ = attention->register_module("q_proj", torch::nn::Linear(width, width));
        key_ = attention->register_module("k_proj", torch::nn::Linear(width, width));
        value_ = attention->register_module("v_proj", torch::nn::Linear(width, width));
        output_ = attention->register_module("out_proj", torch::nn::Linear(width, width));
        register_module("self_attn", attention);
        norm1_ = register_module("self_attn_layer_norm", norm());
        feed_in_ = register_module("fc1", torch::nn::Linear(width, config.ffn_dim));
        feed_out_ = register_module("fc2", torch::nn::Linear(config.ffn_dim, width));
        norm2_ = register_module("final_layer_norm", norm());
    }
    at::Tensor forward(at::Tensor x, const at::Tensor& mask, KeyValues* cache) {
        const at::Tensor normed = norm1_(x);
        KeyValues all{key_(normed), value_(normed)};
        if (cache) {
            cache->append(all.keys, all.values);
            all = *cache;
        }
        x = x + output_(attention(query_(normed), all.keys, all.values, heads_, mask));
        return x + feed_out_(at::relu(feed_in_(norm2_(x))));
    }

  private:
    int heads_;
    torch::nn::Linear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
    torch::nn::Linear feed_in_{nullptr}, feed_out_{nullptr};
    nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
};

OptModelImpl::OptModelImpl(const OptConfig& config) : config_(config) {
    const int width = config_.hidden_size;
    auto decoder = std::make_shared<nn::Module>("decoder");
    words_ =
        decoder->register_module("embed_tokens", torch::nn::Embedding(config_.vocab_size, width));
    positions_ = decoder->register_module(
        "embed_positions",
        torch::nn::Embedding(config_.max_position_embeddings + position_offset, width));
    nn::ModuleList layers;
    for (int i = 0; i < config_.num_hidden_layers; ++i) {
        layers_.push_back(std::make_shared<Layer>(config_));
        layers->push_back(layers_.back());
    }
    decoder->register_module("layers", layers.ptr());
    final_norm_ =
        decoder->register_module("final_layer_norm", nn::LayerNorm(nn::LayerNormOptions({width})));
    auto model = std::make_shared<nn::Module>("model");
    model->register_module("decoder", decoder);
    register_module("model", model);
}

at::Tensor OptModelImpl::forward(const at::Tensor& embeddings, const at::Tensor& visible,
                                 KeyValueCache* cache) {
    const auto before = cache ? cache->length() : 0;
    const auto count = embeddings.size(1);
    ITEM3D_CHECK(visible.size(1) == before + count, "visible must cover the cached tokens and x");
    ITEM3D_CHECK(before + count <= config_.max_position_embeddings, "the text is too long");
    if (cache) cache->layers.resize(layers_.size());
    const at::Tensor positions =
        (visible.cumsum(1) * visible - 1 + position_offset).narrow(1, before, count);
    const at::Tensor mask = causal_mask(visible, count);
    at::Tensor x = embeddings + positions_(positions);
    for (std::size_t i = 0; i < layers_.size(); ++i)
        x = layers_[i]->forward(x, mask, cache ? &cache->layers[i] : nullptr);
    return final_norm_(x);
}

OptConfig OptConfig::from_config(const Config& config) {
    OptConfig result;
    if (config.text("model_type", "") != "opt")
        config.fail("model_type", "\"opt\" (other language models are not supported)");
    result.vocab_size = config.size("vocab_size", result.vocab_size);
    result.hidden_size = config.size("hidden_size", result.hidden_size);
    result.ffn_dim = config.size("ffn_dim", result.ffn_dim);
    result.num_hidden_layers = config.size("num_hidden_layers", result.num_hidden_layers);
    result.num_attention_heads = config.size("num_attention_heads", result.num_attention_heads);
    result.max_position_embeddings =
        config.size("max_position_embeddings", result.max_position_embeddings);
    result.bos_token_id = config.integer("bos_token_id", result.bos_token_id);
    result.eos_token_id = config.integer("eos_token_id", result.eos_token_id);
    result.pad_token_id = config.integer("pad_token_id", result.pad_token_id);
    config.expect("activation_function", "relu");
    for (const char* flag : {"do_layer_norm_before", "enable_bias", "layer_norm_elementwise_affine",
                             "tie_word_embeddings"})
        config.expect(flag, true);
    config.expect("_remove_final_layer_norm", false);
    config.expect("word_embed_proj_dim", result.hidden_size);
    if (result.hidden_size % result.num_attention_heads != 0)
        config.fail("num_attention_heads", "a divisor of hidden_size");
    if (result.num_hidden_layers > 256) config.fail("num_hidden_layers", "at most 256");
    return result;
}

double OptConfig::min_parameters() const {
    const double width = hidden_size;
    return width * (vocab_size + max_position_embeddings) +
           num_hidden_layers * (4 * width * width + 2 * width * ffn_dim);
}

}  // namespace item3d
