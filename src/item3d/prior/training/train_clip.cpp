#include "item3d/prior/training/train_clip.h"

#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/prior/training/train_diffusion.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/prior/training/vision_language.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr int clip_batch = 48;
/// Number of sentences about other images that are added to those of the batch. They cost little.
constexpr int more_sentences = 80;

ClipModel make_clip(const TrainSettings& settings, const ClipConfig& config) {
    at::manual_seed(static_cast<std::int64_t>(settings.seed) + 2);
    ClipModel model(config);
    const at::NoGradGuard no_grad;
    for (auto& item : model->named_parameters()) {
        const auto is = [&](const char* part) {
            return item.key().find(part) != std::string::npos;
        };
        if (is("token_embedding")) item.value().normal_(0, .3);
        if (is("position_embedding") || is("class_embedding")) item.value().normal_(0, .05);
        if (is("logit_scale")) item.value().fill_(2.6592);  // 1 / 0.07, as in the paper
    }
    return model;
}

at::Tensor unit(const at::Tensor& features) {
    const at::Tensor x = features.to(at::kFloat);
    return x / x.norm(2, {-1}, true).clamp_min(1e-6);
}

/// Returns the cross-entropy of each row's softmax with a uniform distribution over its true
/// entries.
at::Tensor true_share_loss(const at::Tensor& logits, const at::Tensor& truth) {
    const at::Tensor wanted = truth / truth.sum(1, true);
    return -(wanted * logits.log_softmax(1)).sum(1).mean();
}

/// Returns CLIP's symmetric loss. A sentence that is true of several images counts as a match for
/// each of them.
at::Tensor clip_loss(ClipModel model, const LabeledImages& data, const ClipTokenizer& tokenizer,
                     const std::vector<std::int64_t>& rows, Random random) {
    std::vector<ClaimedLabels> claims;
    std::vector<std::string> texts;
    const auto say = [&](std::int64_t row) {
        claims.push_back(draw_claim(random, data.labels[static_cast<std::size_t>(row)]));
        texts.push_back(claims.back().text(draw_frame(random)));
    };
    for (const std::int64_t row : rows)
        say(row);
    for (int i = 0; i < more_sentences; ++i)
        say(random.index(data.count()));

    const auto count = static_cast<std::int64_t>(rows.size());
    at::Tensor truth = at::zeros({count, static_cast<std::int64_t>(claims.size())});
    auto* value = truth.data_ptr<float>();
    for (const std::int64_t row : rows)
        for (const ClaimedLabels& claim : claims)
            *value++ = holds(claim, data.labels[static_cast<std::size_t>(row)]) ? 1.0f : 0.0f;

    at::Tensor images, sentences;
    {
        const at::Device device = model->logit_scale().device();
        const Autocast autocast(device);
        images = model->image_features(augment(data.pixel_values(rows).to(device), random));
        sentences = model->text_features(read_sentences(tokenizer, texts).to(device));
    }
    truth = truth.to(images.device());
    const at::Tensor logits =
        model->logit_scale().clamp_max(100) * unit(images).mm(unit(sentences).t());
    const auto of_images = [&](const at::Tensor& all) { return all.narrow(1, 0, count).t(); };
    return .5 *
           (true_share_loss(logits, truth) + true_share_loss(of_images(logits), of_images(truth)));
}

/// Returns a few images as network inputs.
at::Tensor first_images(const LabeledImages& data, std::uint64_t seed) {
    std::vector<std::int64_t> rows(
        static_cast<std::size_t>(std::min<std::int64_t>(64, data.count())));
    std::iota(rows.begin(), rows.end(), 0);
    Random random(seed, 0xc11800);
    return augment(data.pixel_values(rows), random);
}

}  // namespace

ClipConfig prior_clip_config(int vocabulary, int start_of_text, int end_of_text) {
    ClipConfig config;
    config.projection_dim = 128;
    config.text = prior_text_config(vocabulary, start_of_text, end_of_text);
    config.text.hidden_size = 128;
    config.text.intermediate_size = 512;
    config.text.num_hidden_layers = 2;
    config.text.num_attention_heads = 4;
    config.text.projection_dim = 128;
    static_cast<VisionShape&>(config.vision) = prior_vision_shape;
    config.vision.hidden_act = "gelu";  // like the captioner's
    config.vision.projection_dim = 128;
    return config;
}

bool copy_vision(const BlipModel& from, const ClipModel& to, const at::Tensor& pixel_values) {
    const ClipVisionConfig config = to->config().vision;
    const VisionShape& shape = config;
    if (shape != from->config().vision || config.hidden_act != "gelu") return false;

    const at::NoGradGuard no_grad;
    const std::string vision = "vision_model.";
    const auto theirs = from->named_parameters();
    auto ours = to->named_parameters();
    const auto their = [&](const std::string& name) { return theirs[vision + name]; };
    const auto set = [&](const std::string& name, const at::Tensor& value) {
        at::Tensor& target = ours[vision + name];
        target.copy_(value.reshape(target.sizes()));
    };
    const at::Tensor patch = their("embeddings.patch_embedding.weight");
    at::Tensor positions = their("embeddings.position_embedding")[0].clone();
    positions.slice(0, 1) += their("embeddings.patch_embedding.bias");
    set("embeddings.class_embedding", their("embeddings.class_embedding"));
    set("embeddings.patch_embedding.weight", patch);
    set("embeddings.position_embedding.weight", positions);
    const at::Tensor states =
        at::conv2d(pixel_values, patch, {}, config.patch_size).flatten(2).transpose(1, 2) +
        positions.slice(0, 1);
    ours[vision + "pre_layrnorm.weight"].fill_(states.std(-1).mean());

    for (const char* suffix : {".weight", ".bias"}) {
        set(std::string("post_layernorm") + suffix, their(std::string("post_layernorm") + suffix));
        for (int i = 0; i < config.num_hidden_layers; ++i) {
            const std::string layer = "encoder.layers." + std::to_string(i) + ".";
            const std::string attention = layer + "self_attn.";
            const auto qkv = their(attention + "qkv" + suffix).chunk(3, 0);
            set(attention + "q_proj" + suffix, qkv[0]);
            set(attention + "k_proj" + suffix, qkv[1]);
            set(attention + "v_proj" + suffix, qkv[2]);
            set(attention + "out_proj" + suffix, their(attention + "projection" + suffix));
            for (const char* same : {"layer_norm1", "layer_norm2", "mlp.fc1", "mlp.fc2"})
                set(layer + same + suffix, their(layer + same + suffix));
        }
    }
    return true;
}

nlohmann::json train_clip(const LabeledImages& data, const TrainSettings& settings,
                          const ClipTokenizer& tokenizer, const ClipConfig& config) {
    const auto begin = init_from_part(settings, clip_folder);
    BlipModel captioner{nullptr};
    // The other processes get their first values from process 0.
    if (begin.empty() && settings.processes.first() &&
        fs::exists(settings.output / captioner_folder / "config.json"))
        captioner = load_blip(settings.output / captioner_folder);
    const at::Tensor sample = first_images(data, settings.seed);
    bool warm = false;
    std::vector<LoopReplica> replicas;
    for (int rank = 0; rank < settings.replicas; ++rank) {
        ClipModel model = make_clip(settings, config);
        if (!begin.empty()) init_from_clip(begin, model);
        if (captioner) warm = copy_vision(captioner, model, sample);
        model->to(settings.device);
        const auto stream = static_cast<std::uint64_t>(global_rank(settings, rank));
        replicas.push_back({{model.ptr()}, [&, model, stream](const auto& rows, auto step) {
                                const Random random(settings.seed, 0xc11900 + stream,
                                                    static_cast<std::uint64_t>(step) * 65536);
                                return clip_loss(model, data, tokenizer, rows, random);
                            }});
    }
    LoopOptions options =
        vision_language_loop("clip", settings, settings.clip_samples, data.count());
    options.batch = clip_batch;
    if (warm) note("clip: its vision transformer is initialized from the captioner's");
    TrainingLoop loop(options, std::move(replicas));

    const auto folder = settings.output / clip_folder;
    if (settings.processes.first()) {
        make_output_folder(folder);
        tokenizer.save(folder);
        write_preprocessor(folder, "CLIPImageProcessor");
    }
    const ClipModel exported = make_clip(settings, config);
    FlatModel flat({exported.ptr()});
    nlohmann::json train;
    loop.run([&](const at::Tensor& average, const LoopRecord& record) {
        flat.values.copy_(average);
        save_clip_model(folder, exported);
        train = loop_summary(record, loop.parameters(), settings);
    });
    return train;
}

}  // namespace item3d
