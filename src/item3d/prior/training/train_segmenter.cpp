#include "item3d/prior/training/train_segmenter.h"

#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/prior/training/train_clip.h"
#include "item3d/prior/training/train_diffusion.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/prior/training/vision_language.h"

#include <ATen/ops/affine_grid_generator.h>
#include <ATen/ops/grid_sampler.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Prompts per image. One pass of the vision transformer serves all prompts of an image.
constexpr int prompts_a_image = 6;
/// Edges of the network's input and of its patches, in pixels. There are 14 patches along a side,
/// so that a part as small as a handle covers several patches.
constexpr int segmenter_read_size = 112;
constexpr int segmenter_patch = 8;
/// Segmenter's learning rate as a multiple of the U-Net's maximum, and the number of warm-up steps.
constexpr float segmenter_rate = 1.5f;
constexpr int segmenter_rise = 60;

ClipSegModel make_segmenter(const TrainSettings& settings, const ClipSegConfig& config) {
    at::manual_seed(static_cast<std::int64_t>(settings.seed) + 4);
    ClipSegModel model(config);
    const at::NoGradGuard no_grad;
    for (auto& item : model->named_parameters()) {
        const auto is = [&](const char* part) {
            return item.key().find(part) != std::string::npos;
        };
        if (is("token_embedding")) item.value().normal_(0, .3);
        if (is("position_embedding") || is("class_embedding")) item.value().normal_(0, .05);
        // Initially, a prompt scales the visual features by about 1.
        if (is("film_mul.bias")) item.value().fill_(1);
        // Most pixels of an image do not belong to what a prompt names.
        if (is("transposed_convolution.4.bias")) item.value().fill_(-1);
        if (is("logit_scale")) item.value().fill_(2.6592);
    }
    return model;
}

/// Returns the mean cross-entropy of the pixels, plus 1 - Dice (Milletari et al. 2016) for prompts
/// with a match. In the Dice term small parts count as much as large ones. logits, truth:
/// [N, P, h, w].
at::Tensor mask_loss(const at::Tensor& logits, const at::Tensor& truth) {
    const at::Tensor x = logits.to(at::kFloat).flatten(2), wanted = truth.flatten(2);
    const at::Tensor entropy = (at::softplus(x) - x * wanted).mean();
    const at::Tensor found = at::sigmoid(x);
    const at::Tensor both = (found * wanted).sum(2);
    const at::Tensor dice = (2 * both + 1) / (found.sum(2) + wanted.sum(2) + 1);
    const at::Tensor named = wanted.sum(2).gt(0).to(at::kFloat);
    return entropy + .5 * ((1 - dice) * named).sum() / named.sum().clamp_min(1);
}

/// Returns one random transform for each image, [N, 2, 3] for affine_grid_generator. A transform
/// mirrors half of the time, and slightly rotates, scales and shifts. Shapes outside the training
/// data have other poses in their images.
at::Tensor random_places(Random& random, std::int64_t count) {
    at::Tensor places = at::empty({count, 2, 3});
    auto* place = places.mutable_data_ptr<float>();
    for (std::int64_t i = 0; i < count; ++i, place += 6) {
        const double angle = random.normal(0, .15), size = std::exp(random.normal(0, .2));
        const double mirror = random.chance(.5) ? -1 : 1;
        const double c = std::cos(angle) / size, s = std::sin(angle) / size;
        place[0] = static_cast<float>(mirror * c);
        place[1] = static_cast<float>(-s);
        place[2] = static_cast<float>(random.normal(0, .08));
        place[3] = static_cast<float>(mirror * s);
        place[4] = static_cast<float>(c);
        place[5] = static_cast<float>(random.normal(0, .08));
    }
    return places;
}

at::Tensor segmenter_loss(ClipSegModel model, const PartImages& data,
                          const ClipTokenizer& tokenizer, const std::vector<std::int64_t>& rows,
                          Random random) {
    std::vector<std::string> texts;
    std::vector<at::Tensor> masks;
    for (const std::int64_t row : rows)
        for (int i = 0; i < prompts_a_image; ++i) {
            const PartPrompt prompt =
                draw_part_prompt(random, data.labels[static_cast<std::size_t>(row)]);
            texts.push_back(prompt.text);
            masks.push_back(data.mask(row, prompt.parts));
        }
    const auto count = static_cast<std::int64_t>(rows.size());
    const at::Device device = model->parameters().front().device();
    const at::Tensor images = data.pixel_values(rows).to(device);
    const std::int64_t size = model->config().clip.vision.image_size;
    const at::Tensor grid = at::affine_grid_generator(random_places(random, count).to(device),
                                                      {count, 3, size, size}, false);
    constexpr int bilinear = 0, zeros = 0, border = 1;
    const at::Tensor read = at::grid_sampler(images, grid, bilinear, border, false);
    const at::Tensor placed = at::grid_sampler(
        at::stack(masks).to(device).view({count, prompts_a_image, images.size(2), images.size(3)}),
        grid, bilinear, zeros, false);
    at::Tensor logits;
    {
        const Autocast autocast(device);
        const at::Tensor asked =
            model->conditional_embeddings(read_sentences(tokenizer, texts).to(device))
                .view({count, prompts_a_image, -1});
        logits = model->forward(read, asked);
    }
    return mask_loss(logits, at::adaptive_avg_pool2d(placed, {logits.size(2), logits.size(3)}));
}

}  // namespace

ClipSegConfig prior_segmenter_config(int vocabulary, int start_of_text, int end_of_text) {
    ClipSegConfig config;
    config.clip = prior_clip_config(vocabulary, start_of_text, end_of_text);
    config.clip.vision.image_size = segmenter_read_size;
    config.clip.vision.patch_size = segmenter_patch;
    config.extract_layers = {1, 3, 5};
    config.reduce_dim = 64;
    config.decoder_num_attention_heads = 4;
    config.decoder_intermediate_size = 256;
    config.use_complex_transposed_convolution = true;
    return config;
}

bool copy_clip(const ClipModel& from, const ClipSegModel& to) {
    const ClipConfig& theirs = from->config();
    const ClipConfig& ours = to->config().clip;
    VisionShape seen = theirs.vision;
    seen.image_size = ours.vision.image_size;
    seen.patch_size = ours.vision.patch_size;
    seen.num_hidden_layers = ours.vision.num_hidden_layers;
    if (seen != ours.vision || theirs.vision.hidden_act != ours.vision.hidden_act ||
        theirs.vision.num_hidden_layers < ours.vision.num_hidden_layers ||
        theirs.text.to_json() != ours.text.to_json() ||
        theirs.projection_dim != ours.projection_dim)
        return false;

    const at::NoGradGuard no_grad;
    const auto given = from->named_parameters();
    for (auto& item : to->named_parameters()) {
        if (!item.key().starts_with("clip.")) continue;
        const std::string name = item.key().substr(5);
        at::Tensor value = given[name];
        if (name == "vision_model.embeddings.patch_embedding.weight") {
            const std::int64_t size = ours.vision.patch_size;
            if (value.size(2) != size)
                value = at::_upsample_bicubic2d_aa(value, {size, size}, false) *
                        (static_cast<double>(value.size(2) * value.size(2)) /
                         static_cast<double>(size * size));
        } else if (name == "vision_model.embeddings.position_embedding.weight" &&
                   value.sizes() != item.value().sizes()) {
            const std::int64_t before = theirs.vision.image_size / theirs.vision.patch_size;
            const std::int64_t side = ours.vision.image_size / ours.vision.patch_size;
            const at::Tensor map =
                value.slice(0, 1).view({1, before, before, -1}).permute({0, 3, 1, 2});
            value = at::cat({value.slice(0, 0, 1),
                             at::upsample_bicubic2d(map, {side, side}, false)[0].flatten(1).t()});
        }
        item.value().copy_(value);
    }
    return true;
}

nlohmann::json train_segmenter(const PartImages& data, const TrainSettings& settings,
                               const ClipTokenizer& tokenizer, const ClipSegConfig& config,
                               const fs::path& begin) {
    const bool has_begin = !begin.empty();
    const bool is_segmenter =
        has_begin && Config::read(begin / "config.json").text("model_type", "") == "clipseg";
    bool warm = false;
    std::vector<LoopReplica> replicas;
    for (int rank = 0; rank < settings.replicas; ++rank) {
        ClipSegModel model = make_segmenter(settings, config);
        if (is_segmenter)
            init_from_segmenter(begin, model);
        else if (has_begin)
            warm = copy_clip(load_clip_model(begin), model);
        model->to(settings.device);
        const auto stream = static_cast<std::uint64_t>(global_rank(settings, rank));
        replicas.push_back({{model.ptr()}, [&, model, stream](const auto& rows, auto step) {
                                const Random random(settings.seed, 0xd11900 + stream,
                                                    static_cast<std::uint64_t>(step) * 65536);
                                return segmenter_loss(model, data, tokenizer, rows, random);
                            }});
    }
    LoopOptions options =
        vision_language_loop("segmenter", settings, settings.segmenter_samples, data.count());
    options.batch = settings.segmenter_batch;
    options.rise = static_cast<double>(segmenter_rise) * options.batch * settings.replicas *
                   settings.processes.size();
    options.learning_rate *= segmenter_rate;
    if (warm) note("segmenter: its text and image encoders are initialized from CLIP's");
    TrainingLoop loop(options, std::move(replicas));

    const auto folder = settings.output / segmenter_folder;
    if (settings.processes.first()) {
        make_output_folder(folder);
        tokenizer.save(folder);
        write_preprocessor(folder, "ViTImageProcessor", config.clip.vision.image_size);
    }
    const ClipSegModel exported = make_segmenter(settings, config);
    FlatModel flat({exported.ptr()});
    nlohmann::json train;
    loop.run([&](const at::Tensor& average, const LoopRecord& record) {
        flat.values.copy_(average);
        save_clip_seg(folder, exported);
        train = loop_summary(record, loop.parameters(), settings);
    });
    return train;
}

}  // namespace item3d
