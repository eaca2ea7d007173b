#include "item3d/networks/vision_language/clip_model.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

namespace item3d {
namespace nn = torch::nn;
ClipConfig ClipConfig::from_config(const Config& config) {
    for (const std::string& name : config.texts("architectures", {}))
        if (name != "CLIPModel") config.fail("architectures", "CLIPModel");
    return from_parts(config);
}

ClipConfig ClipConfig::from_parts(const Config& config) {
    ClipConfig result;
    result.text = ClipTextConfig::from_config(config.part("text_config"));
    result.vision = ClipVisionConfig::from_config(config.part("vision_config"));
    result.projection_dim = config.size("projection_dim", result.projection_dim);
    return result;
}

nlohmann::json ClipConfig::to_json() const {
    nlohmann::json text_json = text.to_json();
    text_json.erase("architectures");
    return {{"architectures", {"CLIPModel"}},
            {"model_type", "clip"},
            {"projection_dim", projection_dim},
            {"text_config", text_json},
            {"vision_config", vision.to_json()}};
}

ClipModelImpl::ClipModelImpl(const ClipConfig& config) : config_(config) {
    config_.text.with_projection = false;  // the projection is not part of the text model here
    text_ = register_module("text_model", ClipTextModel(config_.text));
    vision_ = register_module("vision_model", ClipVisionModel(config_.vision));
    const auto projection = [&](int width) {
        return nn::Linear(nn::LinearOptions(width, config_.projection_dim).bias(false));
    };
    text_projection_ = register_module("text_projection", projection(config_.text.hidden_size));
    visual_projection_ =
        register_module("visual_projection", projection(config_.vision.hidden_size));
    logit_scale_ = register_parameter("logit_scale", at::zeros({}));
}

at::Tensor ClipModelImpl::image_features(const at::Tensor& pixel_values) {
    return visual_projection_(vision_->pooled(pixel_values));
}

at::Tensor ClipModelImpl::text_features(const at::Tensor& input_ids,
                                        const at::Tensor& attention_mask) {
    return text_projection_(text_(input_ids, attention_mask).pooled);
}

ClipModel load_clip_model(const std::filesystem::path& folder, at::Device device,
                          at::ScalarType dtype) {
    const auto config = ClipConfig::from_config(Config::read(folder / "config.json"));
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        return name.ends_with("embeddings.position_ids") ? "" : name;  // a constant of old files
    });
    check_plausible(weights, config.text.min_parameters() + config.vision.min_parameters());
    auto model = without_initial_values([&] { return ClipModel(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

void save_clip_model(const std::filesystem::path& folder, const ClipModel& model,
                     at::ScalarType dtype) {
    write_atomically(folder / "config.json", model->config().to_json().dump(2) + "\n");
    save_safetensors(folder / "model.safetensors", module_tensors(*model, dtype),
                     {{"format", "pt"}});
}

}  // namespace item3d
