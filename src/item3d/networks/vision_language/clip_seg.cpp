#include "item3d/networks/vision_language/clip_seg.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/layers/attention.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

#include <algorithm>

namespace item3d {
namespace nn = torch::nn;
namespace {

constexpr const char* clip_seg_class = "CLIPSegForImageSegmentation";

/// Returns the edge of a patch's mask in pixels.
int pixels_a_patch(const ClipSegConfig& config) {
    const int patch = config.clip.vision.patch_size;
    return config.use_complex_transposed_convolution ? (patch / 4) * (patch / 4) : patch;
}

}  // namespace

ClipSegConfig ClipSegConfig::from_config(const Config& config) {
    const auto names = config.texts("architectures", {});
    for (const std::string& name : names)
        if (name != clip_seg_class) config.fail("architectures", clip_seg_class);
    if (names.empty() && config.text("model_type", "") != "clipseg")
        config.fail("model_type", "clipseg");
    ClipSegConfig result;
    result.clip = ClipConfig::from_parts(config);
    result.extract_layers = config.integers("extract_layers", result.extract_layers);
    result.reduce_dim = config.size("reduce_dim", result.reduce_dim);
    result.decoder_num_attention_heads =
        config.size("decoder_num_attention_heads", result.decoder_num_attention_heads);
    result.decoder_intermediate_size =
        config.size("decoder_intermediate_size", result.decoder_intermediate_size);
    result.conditional_layer = config.integer("conditional_layer", result.conditional_layer);
    result.use_complex_transposed_convolution = config.boolean(
        "use_complex_transposed_convolution", result.use_complex_transposed_convolution);
    const VisionShape& vision = result.clip.vision;
    if (result.extract_layers.empty() || result.extract_layers.size() > 256)
        config.fail("extract_layers", "1 to 256 layers");
    for (const int layer : result.extract_layers)
        if (layer < 0 || layer >= vision.num_hidden_layers)
            config.fail("extract_layers", "layer numbers of the vision model, from 0");
    if (result.conditional_layer < 0 ||
        result.conditional_layer >= static_cast<int>(result.extract_layers.size()))
        config.fail("conditional_layer", "a layer number of the decoder, from 0");
    if (result.reduce_dim % result.decoder_num_attention_heads != 0)
        config.fail("decoder_num_attention_heads", "a divisor of reduce_dim");
    if (result.use_complex_transposed_convolution &&
        (vision.patch_size < 4 || result.reduce_dim < 2))
        config.fail("use_complex_transposed_convolution",
                    "false for patches of less than 4 pixels");
    return result;
}

nlohmann::json ClipSegConfig::to_json() const {
    nlohmann::json json = clip.to_json();
    json.update({{"architectures", {clip_seg_class}},
                 {"model_type", "clipseg"},
                 {"extract_layers", extract_layers},
                 {"reduce_dim", reduce_dim},
                 {"decoder_num_attention_heads", decoder_num_attention_heads},
                 {"decoder_intermediate_size", decoder_intermediate_size},
                 {"decoder_attention_dropout", 0.0},
                 {"decoder_hidden_act", "quick_gelu"},
                 {"conditional_layer", conditional_layer},
                 {"use_complex_transposed_convolution", use_complex_transposed_convolution}});
    json["text_config"]["model_type"] = "clipseg_text_model";
    json["vision_config"]["model_type"] = "clipseg_vision_model";
    return json;
}

int ClipSegConfig::mask_size(int image) const {
    return image / clip.vision.patch_size * pixels_a_patch(*this);
}

double ClipSegConfig::min_parameters() const {
    const double width = reduce_dim, depth = static_cast<double>(extract_layers.size());
    return clip.text.min_parameters() + clip.vision.min_parameters() +
           depth * width * (4 * width + 2.0 * decoder_intermediate_size);
}

ClipSegLayerImpl::ClipSegLayerImpl(int width, int intermediate, int heads, double epsilon)
    : heads_(heads) {
    const auto norm = nn::LayerNormOptions({width}).eps(epsilon);
    norm1_ = register_module("layer_norm1", nn::LayerNorm(norm));
    norm2_ = register_module("layer_norm2", nn::LayerNorm(norm));
    auto attending = std::make_shared<nn::Module>("attention");
    query_ = attending->register_module("q_proj", PackableLinear(width, width));
    key_ = attending->register_module("k_proj", PackableLinear(width, width));
    value_ = attending->register_module("v_proj", PackableLinear(width, width));
    output_ = attending->register_module("out_proj", PackableLinear(width, width));
    register_module("self_attn", attending);
    auto mlp = std::make_shared<nn::Module>("mlp");
    feed_in_ = mlp->register_module("fc1", PackableLinear(width, intermediate));
    feed_out_ = mlp->register_module("fc2", PackableLinear(intermediate, width));
    register_module("mlp", mlp);
}

at::Tensor ClipSegLayerImpl::forward(const at::Tensor& x) {
    const at::Tensor read = query_->as_read(x);
    const at::Tensor heard = attention(query_(read), key_(read), value_(read), heads_);
    const at::Tensor y = norm1_(output_->forward(heard, {.added = x}));
    // The MLP's activation is a ReLU for any config, as in transformers.
    return norm2_(feed_out_->forward(at::relu(feed_in_(y)), {.added = y}));
}

ClipSegDecoderImpl::ClipSegDecoderImpl(const ClipSegConfig& config) : config_(config) {
    const int width = config_.reduce_dim, patch = config_.clip.vision.patch_size;
    film_mul_ = register_module("film_mul", nn::Linear(config_.clip.projection_dim, width));
    film_add_ = register_module("film_add", nn::Linear(config_.clip.projection_dim, width));
    const auto enlarging = [](int from, int to, int size) {
        return nn::ConvTranspose2d(nn::ConvTranspose2dOptions(from, to, size).stride(size));
    };
    if (config_.use_complex_transposed_convolution) {
        auto steps = std::make_shared<nn::Module>("transposed_convolution");
        smooth_ =
            steps->register_module("0", nn::Conv2d(nn::Conv2dOptions(width, width, 3).padding(1)));
        upscalers_.push_back(steps->register_module("2", enlarging(width, width / 2, patch / 4)));
        upscalers_.push_back(steps->register_module("4", enlarging(width / 2, 1, patch / 4)));
        register_module("transposed_convolution", steps);
    } else {
        upscalers_.push_back(register_module("transposed_convolution", enlarging(width, 1, patch)));
    }
    nn::ModuleList reduces, layers;
    for (std::size_t i = 0; i < config_.extract_layers.size(); ++i) {
        reduces_.emplace_back(config_.clip.vision.hidden_size, width);
        reduces->push_back(reduces_.back());
        layers_.push_back(ClipSegLayer(width, config_.decoder_intermediate_size,
                                       config_.decoder_num_attention_heads,
                                       config_.clip.vision.layer_norm_eps));
        layers->push_back(layers_.back());
    }
    register_module("reduces", reduces);
    register_module("layers", layers);
}

at::Tensor ClipSegDecoderImpl::upscale(const at::Tensor& x) {
    if (!smooth_) return upscalers_[0](x);
    return upscalers_[1](at::relu(upscalers_[0](at::relu(smooth_(x)))));
}

at::Tensor ClipSegDecoderImpl::forward(const std::vector<at::Tensor>& activations,
                                       const at::Tensor& embeddings, std::int64_t rows,
                                       std::int64_t columns) {
    const std::int64_t images = activations.at(0).size(0), width = config_.reduce_dim;
    const std::int64_t prompts = embeddings.size(-2), tokens = rows * columns + 1;
    const at::Tensor asked = embeddings.dim() == 2 ? embeddings.unsqueeze(0) : embeddings;
    ITEM3D_CHECK(asked.dim() == 3 && (asked.size(0) == 1 || asked.size(0) == images),
                 "embeddings must be [P, E] or [N, P, E]");
    at::Tensor x;  // [N, S, R], then, from the conditional layer on, [N * P, S, R]
    std::int64_t each = 1;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const at::Tensor read = reduces_[i](activations[activations.size() - 1 - i]);
        x = x.defined() ? (x.view({images, each, tokens, width}) + read.unsqueeze(1)) : read;
        if (static_cast<int>(i) == config_.conditional_layer) {
            const at::Tensor scale = film_mul_(asked).unsqueeze(2);  // [1 or N, P, 1, R]
            const at::Tensor shift = film_add_(asked).unsqueeze(2);
            x = scale * x.view({images, 1, tokens, width}) + shift;
            each = prompts;
        }
        x = layers_[i](x.reshape({images * each, tokens, width}));
    }
    const at::Tensor map =
        x.slice(1, 1).transpose(1, 2).reshape({images * prompts, width, rows, columns});
    const at::Tensor logits = upscale(map);
    return logits.view({images, prompts, logits.size(2), logits.size(3)});
}

ClipSegModelImpl::ClipSegModelImpl(const ClipSegConfig& config) : config_(config) {
    clip_ = register_module("clip", ClipModel(config_.clip));
    decoder_ = register_module("decoder", ClipSegDecoder(config_));
}

at::Tensor ClipSegModelImpl::conditional_embeddings(const at::Tensor& input_ids,
                                                    const at::Tensor& attention_mask) {
    return clip_->text_features(input_ids, attention_mask);
}

std::vector<at::Tensor> ClipSegModelImpl::activations(const at::Tensor& pixel_values) {
    const int last =
        *std::max_element(config_.extract_layers.begin(), config_.extract_layers.end());
    const auto states = clip_->vision()->first_layers(pixel_values, last + 1);
    std::vector<at::Tensor> result;
    for (const int layer : config_.extract_layers)
        result.push_back(states[static_cast<std::size_t>(layer)]);
    return result;
}

at::Tensor ClipSegModelImpl::forward(const at::Tensor& pixel_values, const at::Tensor& embeddings) {
    const int patch = config_.clip.vision.patch_size;
    return decoder_->forward(activations(pixel_values), embeddings, pixel_values.size(2) / patch,
                             pixel_values.size(3) / patch);
}

ClipSegModel load_clip_seg(const std::filesystem::path& folder, at::Device device,
                           at::ScalarType dtype) {
    const auto config = ClipSegConfig::from_config(Config::read(folder / "config.json"));
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        return name.ends_with("embeddings.position_ids") ? "" : name;  // a constant of old files
    });
    check_plausible(weights, config.min_parameters());
    auto model = without_initial_values([&] { return ClipSegModel(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

void save_clip_seg(const std::filesystem::path& folder, const ClipSegModel& model,
                   at::ScalarType dtype) {
    write_atomically(folder / "config.json", model->config().to_json().dump(2) + "\n");
    save_safetensors(folder / "model.safetensors", module_tensors(*model, dtype),
                     {{"format", "pt"}});
}

}  // namespace item3d
