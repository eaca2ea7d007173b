#include "item3d/networks/layers/bert_layer.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/attention.h"

namespace item3d {
namespace nn = torch::nn;
namespace {

nn::LayerNorm layer_norm(const BertLayerOptions& options) {
    return nn::LayerNorm(nn::LayerNormOptions({options.width}).eps(options.epsilon));
}

}  // namespace

BertAttentionImpl::BertAttentionImpl(const BertLayerOptions& options, int source_width)
    : heads_(options.heads) {
    auto projections = std::make_shared<nn::Module>("projections");
    query_ = projections->register_module("query", PackableLinear(options.width, options.width));
    key_ = projections->register_module("key", PackableLinear(source_width, options.width));
    value_ = projections->register_module("value", PackableLinear(source_width, options.width));
    register_module(options.attention_name, projections);
    auto output = std::make_shared<nn::Module>("output");
    output_ = output->register_module("dense", PackableLinear(options.width, options.width));
    norm_ = output->register_module("LayerNorm", layer_norm(options));
    register_module("output", output);
}

KeyValues BertAttentionImpl::read(const at::Tensor& source) {
    return {key_(source), value_(source)};
}

at::Tensor BertAttentionImpl::forward(const at::Tensor& x, const KeyValues& source,
                                      const at::Tensor& mask) {
    const auto rows = source.keys.size(0);
    const at::Tensor query = query_(x).reshape({rows, -1, x.size(2)});
    const at::Tensor read = attention(query, source.keys, source.values, heads_, mask);
    return norm_(output_->forward(read.reshape(x.sizes()), {.added = x}));
}

BertLayerImpl::BertLayerImpl(const BertLayerOptions& options) {
    self_ = register_module("attention", BertAttention(options, options.width));
    if (options.memory_width > 0)
        cross_ = register_module("crossattention", BertAttention(options, options.memory_width));
    auto feed_in = std::make_shared<nn::Module>("intermediate");
    feed_in_ =
        feed_in->register_module("dense", PackableLinear(options.width, options.intermediate));
    register_module("intermediate" + options.suffix, feed_in);
    auto feed_out = std::make_shared<nn::Module>("output");
    feed_out_ =
        feed_out->register_module("dense", PackableLinear(options.intermediate, options.width));
    norm_ = feed_out->register_module("LayerNorm", layer_norm(options));
    register_module("output" + options.suffix, feed_out);
}

KeyValues BertLayerImpl::read_memory(const at::Tensor& memory) {
    return cross_ ? cross_->read(memory) : KeyValues{};
}

at::Tensor BertLayerImpl::forward(at::Tensor x, const at::Tensor& mask, KeyValues* cache,
                                  const KeyValues& memory) {
    KeyValues all = self_->read(x);
    if (cache) {
        cache->append(all.keys, all.values);
        all = *cache;
    }
    x = self_->forward(x, all, mask);
    if (cross_) {
        ITEM3D_CHECK(memory.keys.defined() && x.size(0) % memory.keys.size(0) == 0,
                     "each image must have the same number of texts");
        x = cross_->forward(x, memory);
    }
    const at::Tensor hidden =
        feed_in_->forward(x, {.activation = LinearActivation::gelu, .rounded = true});
    return norm_(feed_out_->forward(hidden, {.added = x}));
}

}  // namespace item3d
