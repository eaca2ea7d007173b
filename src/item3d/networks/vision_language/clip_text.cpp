#include "item3d/networks/vision_language/clip_text.h"

#include "item3d/core/error.h"
#include "item3d/networks/layers/clip_layer.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

#include <limits>

namespace item3d {
namespace nn = torch::nn;
namespace {

const std::string prefix = "text_model.";

}  // namespace

ClipTextModelImpl::ClipTextModelImpl(const ClipTextConfig& config) : config_(config) {
    const int width = config_.hidden_size;
    auto embeddings = std::make_shared<nn::Module>("embeddings");
    token_embedding_ =
        embeddings->register_module("token_embedding", nn::Embedding(config_.vocab_size, width));
    position_embedding_ = embeddings->register_module(
        "position_embedding", nn::Embedding(config_.max_position_embeddings, width));
    register_module("embeddings", embeddings);
    {  // CLIP's own initialisation: unit normals would dominate the layers
        const at::NoGradGuard no_grad;
        token_embedding_->weight.normal_(0, 0.02);
        position_embedding_->weight.normal_(0, 0.02);
    }
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
    final_layer_norm_ =
        register_module("final_layer_norm",
                        nn::LayerNorm(nn::LayerNormOptions({width}).eps(config_.layer_norm_eps)));
    if (config_.with_projection)
        text_projection_ = register_module(
            "text_projection",
            nn::Linear(nn::LinearOptions(width, config_.projection_dim).bias(false)));
}

ClipTextOutput ClipTextModelImpl::forward(const at::Tensor& input_ids,
                                          const at::Tensor& attention_mask) {
    ITEM3D_CHECK(input_ids.dim() == 2 && input_ids.size(1) <= config_.max_position_embeddings,
                 "input_ids must be [N, S] with S <= max_position_embeddings");
    const auto length = input_ids.size(1);
    const at::Tensor ids = input_ids.to(at::kLong);
    at::Tensor x = token_embedding_(ids) + position_embedding_->weight.slice(0, 0, length);

    const double hidden = -std::numeric_limits<double>::infinity();
    at::Tensor mask = at::full({length, length}, hidden, x.options().requires_grad(false)).triu(1);
    if (attention_mask.defined()) {
        const at::Tensor unread = attention_mask.to(x.device()).eq(0).unsqueeze(1).unsqueeze(1);
        mask = mask.unsqueeze(0).unsqueeze(0).masked_fill(unread, hidden);
    }

    ClipTextOutput output;
    output.hidden_states.push_back(x);
    for (auto& layer : layers_) {
        x = layer(x, mask);
        output.hidden_states.push_back(x);
    }
    output.last_hidden_state = final_layer_norm_(x);
    const at::Tensor end = config_.eos_token_id == 2
                               ? ids.argmax(1)
                               : ids.eq(config_.eos_token_id).to(at::kInt).argmax(1);
    const at::Tensor rows = at::arange(ids.size(0), end.options());
    output.pooled = output.last_hidden_state.index({rows, end});
    if (text_projection_) output.text_embeds = text_projection_(output.pooled);
    return output;
}

at::Tensor ClipTextModelImpl::skip_layers(const ClipTextOutput& output, int skip) {
    ITEM3D_CHECK(skip >= 0 && skip < static_cast<int>(output.hidden_states.size()),
                 "cannot skip more layers than there are");
    return final_layer_norm_(output.hidden_states[output.hidden_states.size() - 1 - skip]);
}

void ClipTextModelImpl::set_token_embeddings(std::int64_t first_id, const at::Tensor& rows) {
    const at::Tensor& table = token_embedding_->weight;
    ITEM3D_CHECK(rows.dim() == 2 && rows.size(1) == table.size(1) && first_id >= 0,
                 "rows must be [count, hidden_size]");
    const at::NoGradGuard no_grad;
    const std::int64_t end = first_id + rows.size(0);
    at::Tensor larger = at::zeros({std::max(end, table.size(0)), table.size(1)},
                                  table.options().requires_grad(false));
    larger.slice(0, 0, table.size(0)).copy_(table);
    larger.slice(0, first_id, end).copy_(rows);
    token_embedding_->weight.set_data(larger);
    token_embedding_->options.num_embeddings(larger.size(0));
    config_.vocab_size = static_cast<int>(larger.size(0));
}

ClipTextConfig ClipTextConfig::from_json(const nlohmann::json& json, const std::string& subject) {
    return from_config(Config(json, subject));
}

ClipTextConfig ClipTextConfig::from_config(const Config& config) {
    ClipTextConfig result;
    result.vocab_size = config.size("vocab_size", result.vocab_size);
    result.hidden_size = config.size("hidden_size", result.hidden_size);
    result.intermediate_size = config.size("intermediate_size", result.intermediate_size);
    result.num_hidden_layers = config.size("num_hidden_layers", result.num_hidden_layers);
    result.num_attention_heads = config.size("num_attention_heads", result.num_attention_heads);
    result.max_position_embeddings =
        config.size("max_position_embeddings", result.max_position_embeddings);
    result.hidden_act = config.text("hidden_act", result.hidden_act);
    result.layer_norm_eps = config.number("layer_norm_eps", result.layer_norm_eps);
    result.bos_token_id = config.integer("bos_token_id", result.bos_token_id);
    result.eos_token_id = config.integer("eos_token_id", result.eos_token_id);
    result.pad_token_id = config.integer("pad_token_id", result.pad_token_id);
    result.projection_dim = config.size("projection_dim", result.projection_dim);
    for (const std::string& name : config.texts("architectures", {"CLIPTextModel"})) {
        if (name != "CLIPTextModel" && name != "CLIPTextModelWithProjection")
            config.fail("architectures", "CLIPTextModel or CLIPTextModelWithProjection");
        result.with_projection = name == "CLIPTextModelWithProjection";
    }
    if (result.hidden_act != "quick_gelu" && result.hidden_act != "gelu")
        config.fail("hidden_act", "quick_gelu or gelu");
    if (result.hidden_size % result.num_attention_heads != 0)
        config.fail("num_attention_heads", "a divisor of hidden_size");
    if (result.num_hidden_layers > 256) config.fail("num_hidden_layers", "at most 256");
    return result;
}

nlohmann::json ClipTextConfig::to_json() const {
    return {
        {"architectures", {with_projection ? "CLIPTextModelWithProjection" : "CLIPTextModel"}},
        {"attention_dropout", 0.0},
        {"bos_token_id", bos_token_id},
        {"eos_token_id", eos_token_id},
        {"hidden_act", hidden_act},
        {"hidden_size", hidden_size},
        {"intermediate_size", intermediate_size},
        {"layer_norm_eps", layer_norm_eps},
        {"max_position_embeddings", max_position_embeddings},
        {"model_type", "clip_text_model"},
        {"num_attention_heads", num_attention_heads},
        {"num_hidden_layers", num_hidden_layers},
        {"pad_token_id", pad_token_id},
        {"projection_dim", projection_dim},
        {"vocab_size", vocab_size},
    };
}

double ClipTextConfig::min_parameters() const {
    const double width = hidden_size;
    return width * (vocab_size + max_position_embeddings) +
           num_hidden_layers * (4.0 * width * width + 2.0 * width * intermediate_size);
}

ClipTextModel load_clip_text(const std::filesystem::path& folder, at::Device device,
                             at::ScalarType dtype) {
    const auto config = ClipTextConfig::from_config(Config::read(folder / "config.json"));
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        const std::string bare = name.starts_with(prefix) ? name.substr(prefix.size()) : name;
        return bare == "embeddings.position_ids" ? "" : bare;  // a constant that old files hold
    });
    check_plausible(weights, config.min_parameters());
    auto model = without_initial_values([&] { return ClipTextModel(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

std::vector<std::pair<std::string, at::Tensor>> published_tensors(const ClipTextModel& model,
                                                                  at::ScalarType dtype) {
    auto tensors = module_tensors(*model, dtype);
    for (auto& [name, tensor] : tensors)
        if (!name.starts_with("text_projection")) name = prefix + name;
    return tensors;
}

}  // namespace item3d
