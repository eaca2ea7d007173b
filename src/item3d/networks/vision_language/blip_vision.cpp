#include "item3d/networks/vision_language/blip_vision.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/attention.h"
#include "item3d/networks/layers/packable_linear.h"

#include <torch/nn/modules/container/modulelist.h>
#include <torch/nn/modules/embedding.h>

namespace item3d {
namespace nn = torch::nn;

/// Pre-norm layer, with query, key and value in one matrix.
class BlipVisionModelImpl::Layer : public nn::Module {
  public:
    explicit Layer(const BlipVisionConfig& config) : heads_(config.num_attention_heads) {
        const int width = config.hidden_size;
        const auto norm = nn::LayerNormOptions({width}).eps(config.layer_norm_eps);
        auto attention = std::make_shared<nn::Module>("attention");
        qkv_ = attention->register_module("qkv", PackableLinear(width, 3 * width));
        output_ = attention->register_module("projection", PackableLinear(width, width));
        register_module("self_attn", attention);
        norm1_ = register_module("layer_norm1", nn::LayerNorm(norm));
        norm2_ = register_module("layer_norm2", nn::LayerNorm(norm));
        auto mlp = std::make_shared<nn::Module>("mlp");
        feed_in_ = mlp->register_module("fc1", PackableLinear(width, config.intermediate_size));
        feed_out_ = mlp->register_module("fc2", PackableLinear(config.intermediate_size, width));
        register_module("mlp", mlp);
    }
    at::Tensor forward(at::Tensor x) {
        const auto qkv = qkv_(norm1_(x)).chunk(3, -1);
        x = output_->forward(attention(qkv[0], qkv[1], qkv[2], heads_), {.added = x});
        const at::Tensor hidden =
            feed_in_->forward(norm2_(x), {.activation = LinearActivation::gelu, .rounded = true});
        return feed_out_->forward(hidden, {.added = x});
    }

  private:
    int heads_;
    PackableLinear qkv_{nullptr}, output_{nullptr}, feed_in_{nullptr}, feed_out_{nullptr};
    nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
};

BlipVisionModelImpl::BlipVisionModelImpl(const BlipVisionConfig& config) : config_(config) {
    const int width = config_.hidden_size;
    auto embeddings = std::make_shared<nn::Module>("embeddings");
    class_embedding_ = embeddings->register_parameter("class_embedding", at::empty({1, 1, width}));
    position_embedding_ = embeddings->register_parameter("position_embedding",
                                                         at::empty({1, config_.tokens(), width}));
    patch_embedding_ = embeddings->register_module(
        "patch_embedding",
        nn::Conv2d(nn::Conv2dOptions(3, width, config_.patch_size).stride(config_.patch_size)));
    register_module("embeddings", embeddings);
    nn::ModuleList layers;
    for (int i = 0; i < config_.num_hidden_layers; ++i) {
        layers_.push_back(std::make_shared<Layer>(config_));
        layers->push_back(layers_.back());
    }
    auto encoder = std::make_shared<nn::Module>("encoder");
    encoder->register_module("layers", layers.ptr());
    register_module("encoder", encoder);
    post_norm_ = register_module(
        "post_layernorm", nn::LayerNorm(nn::LayerNormOptions({width}).eps(config_.layer_norm_eps)));
}

at::Tensor BlipVisionModelImpl::forward(const at::Tensor& pixel_values) {
    ITEM3D_CHECK(pixel_values.dim() == 4 && pixel_values.size(2) == config_.image_size &&
                     pixel_values.size(3) == config_.image_size,
                 "pixel_values must be [N, 3, image_size, image_size]");
    const at::Tensor patches =  // [N, S - 1, D]
        patch_embedding_(pixel_values.to(class_embedding_.scalar_type()))
            .flatten(2)
            .transpose(1, 2);
    at::Tensor x = at::cat({class_embedding_.expand({patches.size(0), -1, -1}), patches}, 1) +
                   position_embedding_;
    for (const auto& layer : layers_)
        x = layer->forward(x);
    return post_norm_(x);
}

BlipVisionConfig BlipVisionConfig::from_config(const Config& config,
                                               const BlipVisionConfig& defaults) {
    BlipVisionConfig result = defaults;
    result.read(config);
    config.expect("hidden_act", "gelu");
    config.expect("qkv_bias", true);
    return result;
}

nlohmann::json BlipVisionConfig::to_json() const {
    nlohmann::json json = VisionShape::to_json();
    json.update({{"hidden_act", "gelu"}, {"model_type", "blip_vision_model"}});
    return json;
}

}  // namespace item3d
