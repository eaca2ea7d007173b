#include "item3d/networks/vision_language/clip_vision.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

namespace item3d {
namespace nn = torch::nn;

ClipVisionModelImpl::ClipVisionModelImpl(const ClipVisionConfig& config) : config_(config) {
    const int width = config_.hidden_size;
    auto embeddings = std::make_shared<nn::Module>("embeddings");
    class_embedding_ = embeddings->register_parameter("class_embedding", at::zeros({width}));
    patch_embedding_ = embeddings->register_module(
        "patch_embedding",
        nn::Conv2d(nn::Conv2dOptions(config_.num_channels, width, config_.patch_size)
                       .stride(config_.patch_size)
                       .bias(false)));
    position_embedding_ =
        embeddings->register_module("position_embedding", nn::Embedding(config_.tokens(), width));
    register_module("embeddings", embeddings);
    const auto norm = nn::LayerNormOptions({width}).eps(config_.layer_norm_eps);
    pre_norm_ = register_module("pre_layrnorm", nn::LayerNorm(norm));  // the files' own spelling
    nn::ModuleList layers;
    for (int i = 0; i < config_.num_hidden_layers; ++i) {
        layers_.push_back(ClipLayer(ClipLayerOptions{width, config_.intermediate_size,
                                                     config_.num_attention_heads,
                                                     config_.hidden_act, config_.layer_norm_eps}));
        layers->push_back(layers_.back());
    }
    auto encoder = std::make_shared<nn::Module>("encoder");
    encoder->register_module("layers", layers.ptr());
    register_module("encoder", encoder);
    post_norm_ = register_module("post_layernorm", nn::LayerNorm(norm));
}

void ClipVisionModelImpl::check_size(const at::Tensor& pixel_values) const {
    ITEM3D_CHECK(pixel_values.dim() == 4 && pixel_values.size(2) == config_.image_size &&
                     pixel_values.size(3) == config_.image_size,
                 "pixel_values must be [N, C, image_size, image_size]");
}

at::Tensor ClipVisionModelImpl::positions(std::int64_t rows, std::int64_t columns) const {
    const std::int64_t side = config_.image_size / config_.patch_size;
    const at::Tensor& all = position_embedding_->weight;
    if (rows == side && columns == side) return all;
    const at::Tensor map = all.slice(0, 1).view({1, side, side, -1}).permute({0, 3, 1, 2});
    const at::Tensor resized = at::upsample_bicubic2d(map, {rows, columns}, false);
    return at::cat({all.slice(0, 0, 1), resized[0].flatten(1).t()});
}

at::Tensor ClipVisionModelImpl::embed(const at::Tensor& pixel_values) {
    const at::Tensor map = patch_embedding_(pixel_values.to(class_embedding_.scalar_type()));
    const at::Tensor patches = map.flatten(2).transpose(1, 2);  // [N, S - 1, D]
    const at::Tensor token = class_embedding_.expand({patches.size(0), 1, -1});
    return pre_norm_(at::cat({token, patches}, 1) + positions(map.size(2), map.size(3)));
}

std::vector<at::Tensor> ClipVisionModelImpl::first_layers(const at::Tensor& pixel_values,
                                                          int count) {
    ITEM3D_CHECK(count <= static_cast<int>(layers_.size()), "the layer number is too large");
    at::Tensor x = embed(pixel_values);
    std::vector<at::Tensor> states;
    for (int i = 0; i < count; ++i) {
        x = layers_[static_cast<std::size_t>(i)](x);
        states.push_back(x);
    }
    return states;
}

ClipVisionOutput ClipVisionModelImpl::forward(const at::Tensor& pixel_values) {
    check_size(pixel_values);
    at::Tensor x = embed(pixel_values);
    ClipVisionOutput output;
    output.hidden_states.push_back(x);
    for (auto& layer : layers_) {
        x = layer(x);
        output.hidden_states.push_back(x);
    }
    output.last_hidden_state = x;
    output.pooled = post_norm_(x.select(1, 0));
    return output;
}

at::Tensor ClipVisionModelImpl::pooled(const at::Tensor& pixel_values) {
    check_size(pixel_values);
    at::Tensor x = embed(pixel_values);
    for (std::size_t i = 0; i + 1 < layers_.size(); ++i)
        x = layers_[i](x);
    return post_norm_(layers_.back()->forward_first(x).select(1, 0));
}

ClipVisionWithProjectionImpl::ClipVisionWithProjectionImpl(const ClipVisionConfig& config) {
    vision_ = register_module("vision_model", ClipVisionModel(config));
    projection_ = register_module(
        "visual_projection",
        nn::Linear(nn::LinearOptions(config.hidden_size, config.projection_dim).bias(false)));
}

ClipVisionConfig ClipVisionConfig::from_config(const Config& config) {
    ClipVisionConfig result;
    result.read(config);
    result.hidden_act = config.text("hidden_act", result.hidden_act);
    result.projection_dim = config.size("projection_dim", result.projection_dim);
    config.expect("num_channels", 3);
    if (result.hidden_act != "quick_gelu" && result.hidden_act != "gelu")
        config.fail("hidden_act", "quick_gelu or gelu");
    return result;
}

nlohmann::json ClipVisionConfig::to_json() const {
    nlohmann::json json = VisionShape::to_json();
    json.update({{"hidden_act", hidden_act},
                 {"model_type", "clip_vision_model"},
                 {"num_channels", num_channels},
                 {"projection_dim", projection_dim}});
    return json;
}

ClipVisionWithProjection load_clip_vision(const std::filesystem::path& folder, at::Device device,
                                          at::ScalarType dtype) {
    const Config json = Config::read(folder / "config.json");
    for (const std::string& name : json.texts("architectures", {}))
        if (name != "CLIPVisionModelWithProjection")
            json.fail("architectures", "CLIPVisionModelWithProjection");
    const auto config = ClipVisionConfig::from_config(json);
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        return name.ends_with("embeddings.position_ids") ? "" : name;  // a constant of old files
    });
    check_plausible(weights, config.min_parameters());
    auto model = without_initial_values([&] { return ClipVisionWithProjection(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

}  // namespace item3d
