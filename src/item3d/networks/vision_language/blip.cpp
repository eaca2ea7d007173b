#include "item3d/networks/vision_language/blip.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"

#include <torch/nn/modules/container/modulelist.h>

namespace item3d {
namespace nn = torch::nn;

BlipModelImpl::BlipModelImpl(const BlipConfig& config) : config_(config) {
    vision_ = register_module("vision_model", BlipVisionModel(config_.vision));

    const int width = config_.hidden_size;
    const auto norm = nn::LayerNormOptions({width}).eps(config_.layer_norm_eps);
    auto embeddings = std::make_shared<nn::Module>("embeddings");
    words_ = embeddings->register_module("word_embeddings",
                                         torch::nn::Embedding(config_.vocab_size, width));
    positions_ = embeddings->register_module(
        "position_embeddings", torch::nn::Embedding(config_.max_position_embeddings, width));
    embedding_norm_ = embeddings->register_module("LayerNorm", nn::LayerNorm(norm));
    nn::ModuleList layers;
    BertLayerOptions options{width,
                             config_.intermediate_size,
                             config_.num_attention_heads,
                             config_.layer_norm_eps,
                             config_.vision.hidden_size,
                             "self",
                             ""};
    for (int i = 0; i < config_.num_hidden_layers; ++i) {
        layers_.push_back(BertLayer(options));
        layers->push_back(layers_.back());
    }
    auto encoder = std::make_shared<nn::Module>("encoder");
    encoder->register_module("layer", layers.ptr());
    auto bert = std::make_shared<nn::Module>("bert");
    bert->register_module("embeddings", embeddings);
    bert->register_module("encoder", encoder);

    auto transform = std::make_shared<nn::Module>("transform");
    head_ = transform->register_module("dense", PackableLinear(width, width));
    head_norm_ = transform->register_module("LayerNorm", nn::LayerNorm(norm));
    auto predictions = std::make_shared<nn::Module>("predictions");
    head_bias_ = predictions->register_parameter("bias", at::empty({config_.vocab_size}));
    predictions->register_module("transform", transform);
    auto head = std::make_shared<nn::Module>("head");
    head->register_module("predictions", predictions);
    auto decoder = std::make_shared<nn::Module>("decoder");
    decoder->register_module("bert", bert);
    decoder->register_module("cls", head);
    register_module("text_decoder", decoder);
}

std::vector<KeyValues> BlipModelImpl::read_image(const at::Tensor& image_embeds) {
    std::vector<KeyValues> result;
    for (auto& layer : layers_)
        result.push_back(layer->read_memory(image_embeds));
    return result;
}

at::Tensor BlipModelImpl::decode(const at::Tensor& tokens, const at::Tensor& visible,
                                 const std::vector<KeyValues>& image, KeyValueCache* cache) {
    const auto before = cache ? cache->length() : 0;
    const auto count = tokens.size(1);
    ITEM3D_CHECK(before + count <= config_.max_position_embeddings, "the text is too long");
    if (cache) cache->layers.resize(layers_.size());
    const at::Tensor mask = causal_mask(visible, count);
    at::Tensor x = embedding_norm_(words_(tokens) + positions_->weight.narrow(0, before, count));
    for (std::size_t i = 0; i < layers_.size(); ++i)
        x = layers_[i]->forward(x, mask, cache ? &cache->layers[i] : nullptr, image[i]);
    return x;
}

at::Tensor BlipModelImpl::logits(const at::Tensor& states) {
    const at::Tensor x = head_norm_(at::gelu(head_(states)));
    return packed_words_ ? packed_words_->multiply(x, head_bias_)
                         : at::linear(x, words_->weight, head_bias_);
}

void BlipModelImpl::pack(at::ScalarType dtype) {
    pack_linear_layers(*this, dtype);
    if (PackedMatrix::runs(words_->weight.device(), dtype) && PackedMatrix::fits(words_->weight))
        packed_words_.emplace(words_->weight, dtype);
}

BlipConfig BlipConfig::from_config(const Config& config) {
    for (const std::string& name : config.texts("architectures", {}))
        if (name != "BlipForConditionalGeneration")
            config.fail("architectures", "BlipForConditionalGeneration");
    const Config vision = config.part("vision_config"), text = config.part("text_config");
    BlipConfig result;
    result.vision = BlipVisionConfig::from_config(vision, {});
    result.vocab_size = text.size("vocab_size", result.vocab_size);
    result.hidden_size = text.size("hidden_size", result.hidden_size);
    result.intermediate_size = text.size("intermediate_size", result.intermediate_size);
    result.num_hidden_layers = text.size("num_hidden_layers", result.num_hidden_layers);
    result.num_attention_heads = text.size("num_attention_heads", result.num_attention_heads);
    result.max_position_embeddings =
        text.size("max_position_embeddings", result.max_position_embeddings);
    result.layer_norm_eps = text.number("layer_norm_eps", result.layer_norm_eps);
    result.bos_token_id = text.integer("bos_token_id", result.bos_token_id);
    result.sep_token_id = text.integer("sep_token_id", result.sep_token_id);
    result.pad_token_id = text.integer("pad_token_id", result.pad_token_id);
    text.expect("hidden_act", "gelu");
    if (result.hidden_size % result.num_attention_heads != 0)
        text.fail("num_attention_heads", "a divisor of hidden_size");
    if (result.num_hidden_layers > 256) text.fail("num_hidden_layers", "at most 256");
    if (result.bos_token_id < 0 || result.bos_token_id >= result.vocab_size)
        text.fail("bos_token_id", "less than vocab_size");
    return result;
}

nlohmann::json BlipConfig::to_json() const {
    const nlohmann::json text{
        {"attention_probs_dropout_prob", 0.0},
        {"bos_token_id", bos_token_id},
        {"encoder_hidden_size", vision.hidden_size},
        {"eos_token_id", sep_token_id},
        {"hidden_act", "gelu"},
        {"hidden_dropout_prob", 0.0},
        {"hidden_size", hidden_size},
        {"intermediate_size", intermediate_size},
        {"is_decoder", true},
        {"layer_norm_eps", layer_norm_eps},
        {"max_position_embeddings", max_position_embeddings},
        {"model_type", "blip_text_model"},
        {"num_attention_heads", num_attention_heads},
        {"num_hidden_layers", num_hidden_layers},
        {"pad_token_id", pad_token_id},
        {"sep_token_id", sep_token_id},
        {"tie_word_embeddings", true},
        {"use_cache", true},
        {"vocab_size", vocab_size},
    };
    return {{"architectures", {"BlipForConditionalGeneration"}},
            {"model_type", "blip"},
            {"text_config", text},
            {"tie_word_embeddings", true},
            {"vision_config", vision.to_json()}};
}

double BlipConfig::min_parameters() const {
    const double width = hidden_size;
    return vision.min_parameters() + width * (vocab_size + max_position_embeddings) +
           num_hidden_layers * (6 * width * width + 2 * width * intermediate_size);
}

BlipModel load_blip(const std::filesystem::path& folder, at::Device device, at::ScalarType dtype) {
    const auto config = BlipConfig::from_config(Config::read(folder / "config.json"));
    Weights weights = Weights::open(folder, "model");
    weights.rename([](const std::string& name) -> std::string {
        // These tensors are superfluous: a constant, and the output head's copies of the word
        // embeddings and of its own bias.
        const bool spare = name.ends_with("embeddings.position_ids") ||
                           name.starts_with("text_decoder.cls.predictions.decoder.");
        return spare ? "" : name;
    });
    check_plausible(weights, config.min_parameters());
    auto model = without_initial_values([&] { return BlipModel(config); });
    load_parameters(*model, weights, device, dtype);
    model->eval();
    return model;
}

void save_blip(const std::filesystem::path& folder, const BlipModel& model, at::ScalarType dtype) {
    write_atomically(folder / "config.json", model->config().to_json().dump(2) + "\n");
    save_safetensors(folder / "model.safetensors", module_tensors(*model, dtype),
                     {{"format", "pt"}});
}

namespace {

class BlipState : public LanguageModelState {
  public:
    BlipState(const BlipModel& model, const at::Tensor& pixel_values) : model_(model) {
        image_ = model_->read_image(model_->image_embeds(pixel_values));
    }
    at::Tensor read(const at::Tensor& tokens) override {
        const at::Tensor ids = tokens.to(image_.front().keys.device());
        const at::Tensor visible =
            at::ones({ids.size(0), cache_.length() + ids.size(1)}, ids.options());
        const at::Tensor states = model_->decode(ids, visible, image_, &cache_);
        return model_->logits(states.narrow(1, ids.size(1) - 1, 1)).squeeze(1);
    }
    void select(const at::Tensor& rows) override {
        cache_.select(rows.to(image_.front().keys.device()));
    }

  private:
    BlipModel model_;
    std::vector<KeyValues> image_;
    KeyValueCache cache_;
};

}  // namespace

Decoded write_captions(const BlipModel& model, const at::Tensor& pixel_values,
                       const at::Tensor& prompt, DecodingOptions options) {
    const BlipConfig& config = model->config();
    if (prompt.size(1) + options.max_new_tokens > config.max_position_embeddings)
        throw InputError(
            "caption",
            fmt::format(
                "{} tokens of prompt and {} of caption exceed the limit of {} of the network",
                prompt.size(1), options.max_new_tokens, config.max_position_embeddings),
            "shorten the prefix or reduce the number of tokens");
    const at::NoGradGuard no_grad;
    options.end_token = config.sep_token_id;
    options.pad_token = config.pad_token_id;
    BlipState state(model, pixel_values);
    return decode(state, prompt.expand({pixel_values.size(0), -1}), options);
}

}  // namespace item3d
