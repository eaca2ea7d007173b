#include "item3d/networks/vision_language/blip2.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

#include <torch/nn/modules/container/modulelist.h>

namespace item3d {
namespace nn = torch::nn;

Blip2ModelImpl::Blip2ModelImpl(const Blip2Config& config) : config_(config) {
    vision_ = register_module("vision_model", BlipVisionModel(config_.vision));
    const QFormerConfig& qformer = config_.qformer;
    const int width = qformer.hidden_size;
    query_tokens_ =
        register_parameter("query_tokens", at::empty({1, config_.num_query_tokens, width}));

    auto module = std::make_shared<nn::Module>("qformer");
    query_norm_ = module->register_module(
        "layernorm", nn::LayerNorm(nn::LayerNormOptions({width}).eps(qformer.layer_norm_eps)));
    nn::ModuleList layers;
    for (int i = 0; i < qformer.num_hidden_layers; ++i) {
        const bool looks = i % qformer.cross_attention_frequency == 0;
        query_layers_.push_back(BertLayer(BertLayerOptions{
            width, qformer.intermediate_size, qformer.num_attention_heads, qformer.layer_norm_eps,
            looks ? config_.vision.hidden_size : 0, "attention", "_query"}));
        layers->push_back(query_layers_.back());
    }
    auto encoder = std::make_shared<nn::Module>("encoder");
    encoder->register_module("layer", layers.ptr());
    module->register_module("encoder", encoder);
    register_module("qformer", module);

    projection_ =
        register_module("language_projection", torch::nn::Linear(width, config_.text.hidden_size));
    language_model_ = register_module("language_model", OptModel(config_.text));
}

at::Tensor Blip2ModelImpl::query_image(const at::Tensor& image_embeds) {
    at::Tensor x = query_norm_(query_tokens_).expand({image_embeds.size(0), -1, -1});
    for (auto& layer : query_layers_)
        x = layer->forward(x, {}, nullptr, layer->read_memory(image_embeds));
    return x;
}

at::Tensor Blip2ModelImpl::embed(const at::Tensor& ids, const at::Tensor& image) {
    const at::Tensor places = ids.eq(config_.image_token_index);
    ITEM3D_CHECK(places.sum(1).eq(config_.num_query_tokens).all().item<bool>(),
                 "each row must have a placeholder for each image token");
    return language_model_->embed(ids).masked_scatter(places.unsqueeze(-1), image);
}

Blip2Config Blip2Config::from_config(const Config& config) {
    for (const std::string& name : config.texts("architectures", {}))
        if (name != "Blip2ForConditionalGeneration")
            config.fail("architectures", "Blip2ForConditionalGeneration");
    Blip2Config result;
    BlipVisionConfig vision;
    vision.hidden_size = 1408;
    vision.intermediate_size = 6144;
    vision.num_hidden_layers = 39;
    vision.num_attention_heads = 16;
    vision.image_size = 224;
    vision.patch_size = 14;
    vision.layer_norm_eps = 1e-6;
    result.vision = BlipVisionConfig::from_config(config.part("vision_config"), vision);

    const Config qformer = config.part("qformer_config");
    QFormerConfig& q = result.qformer;
    q.hidden_size = qformer.size("hidden_size", q.hidden_size);
    q.intermediate_size = qformer.size("intermediate_size", q.intermediate_size);
    q.num_hidden_layers = qformer.size("num_hidden_layers", q.num_hidden_layers);
    q.num_attention_heads = qformer.size("num_attention_heads", q.num_attention_heads);
    q.cross_attention_frequency =
        qformer.size("cross_attention_frequency", q.cross_attention_frequency);
    q.layer_norm_eps = qformer.number("layer_norm_eps", q.layer_norm_eps);
    qformer.expect("hidden_act", "gelu");
    qformer.expect("use_qformer_text_input", false);
    qformer.expect("encoder_hidden_size", result.vision.hidden_size);
    if (q.hidden_size % q.num_attention_heads != 0)
        qformer.fail("num_attention_heads", "a divisor of hidden_size");
    if (q.num_hidden_layers > 256) qformer.fail("num_hidden_layers", "at most 256");

    result.text = OptConfig::from_config(config.part("text_config"));
    result.num_query_tokens = config.size("num_query_tokens", result.num_query_tokens);
    result.image_token_index = config.integer("image_token_index", result.image_token_index);
    if (result.image_token_index < 0 || result.image_token_index >= result.text.vocab_size)
        config.fail("image_token_index", "less than vocab_size");
    return result;
}

double Blip2Config::min_parameters() const {
    const double width = qformer.hidden_size;
    return vision.min_parameters() + text.min_parameters() +
           qformer.num_hidden_layers * (4 * width * width + 2 * width * qformer.intermediate_size) +
           num_query_tokens * width;
}

Blip2Model load_blip2(const std::filesystem::path& folder, at::Device device,
                      at::ScalarType dtype) {
    const auto config = Blip2Config::from_config(Config::read(folder / "config.json"));
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        const bool spare = name.ends_with("embeddings.position_ids") ||  // a constant
                           name == "language_model.lm_head.weight";      // tied to embed_tokens
        return spare ? "" : name;
    });
    check_plausible(weights, config.min_parameters());
    auto model = without_initial_values([&] { return Blip2Model(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

namespace {

class Blip2State : public LanguageModelState {
  public:
    Blip2State(const Blip2Model& model, const at::Tensor& pixel_values, const at::Tensor& visible)
        : model_(model),
          image_(model_->project(model_->query_image(model_->image_embeds(pixel_values)))),
          prompt_visible_(visible) {}
    at::Tensor read(const at::Tensor& tokens) override {
        OptModel language_model = model_->language_model();
        const at::Tensor ids = tokens.to(image_.device());
        const bool is_prompt = !visible_.defined();
        const at::Tensor embeddings =
            is_prompt ? model_->embed(ids, image_) : language_model->embed(ids);
        visible_ = is_prompt ? prompt_visible_.to(ids) : at::cat({visible_, at::ones_like(ids)}, 1);
        const at::Tensor states = language_model->forward(embeddings, visible_, &cache_);
        return language_model->logits(states.narrow(1, ids.size(1) - 1, 1)).squeeze(1);
    }
    void select(const at::Tensor& rows) override {
        const at::Tensor chosen = rows.to(image_.device());
        cache_.select(chosen);
        visible_ = visible_.index_select(0, chosen);
    }

  private:
    Blip2Model model_;
    at::Tensor image_;           ///< [N, Q, D] in the language model's space
    at::Tensor prompt_visible_;  ///< [N, S]
    at::Tensor visible_;         ///< [rows, tokens read]; undefined before the prompt
    KeyValueCache cache_;
};

}  // namespace

Decoded write_captions(const Blip2Model& model, const at::Tensor& pixel_values,
                       const at::Tensor& prompt, const at::Tensor& visible,
                       DecodingOptions options) {
    const OptConfig& config = model->config().text;
    if (prompt.size(1) + options.max_new_tokens > config.max_position_embeddings)
        throw InputError(
            "caption",
            fmt::format(
                "{} tokens of prompt and {} of caption exceed the limit of {} of the network",
                prompt.size(1), options.max_new_tokens, config.max_position_embeddings));
    const at::NoGradGuard no_grad;
    options.pad_token = config.pad_token_id;
    const at::Tensor rows = prompt.expand({pixel_values.size(0), -1});
    Blip2State state(model, pixel_values,
                     visible.defined() ? visible.expand_as(rows) : at::ones_like(rows));
    return decode(state, rows, options);
}

}  // namespace item3d
