#include "item3d/prior/evaluation/vision_language_accuracy.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace item3d {
namespace {

double rounded(double part) {
    return std::round(part * 10000) / 10000;
}

/// Returns the indices of `count` images such that no caption of one image is true of another. The
/// search begins at the image `next`, which it advances. Returns fewer at the end of the images.
std::vector<std::int64_t> distinct_images(const LabeledImages& images, std::int64_t& next,
                                          int count) {
    std::vector<std::int64_t> rows;
    for (; next < images.count() && static_cast<int>(rows.size()) < count; ++next) {
        const ImageLabels& labels = images.labels[static_cast<std::size_t>(next)];
        const ClaimedLabels claim = plain_claim(labels);
        const bool clashes = std::any_of(rows.begin(), rows.end(), [&](std::int64_t row) {
            const ImageLabels& other = images.labels[static_cast<std::size_t>(row)];
            return holds(claim, other) || holds(plain_claim(other), labels);
        });
        if (!clashes) rows.push_back(next);
    }
    return rows;
}

/// Judges one caption for each of `labels`. caption(i) returns the caption for labels[i]; it is
/// called on any thread.
CaptionAccuracy judge_all(const std::vector<ImageLabels>& labels, int threads,
                          const std::function<std::string(std::size_t)>& caption) {
    CaptionAccuracy result;
    result.count = static_cast<std::int64_t>(labels.size());
    std::mutex mutex;
    std::int64_t done = 0;
    Progress progress("captions", result.count);
    run_workers(result.count, threads, [&](std::int64_t i) {
        const auto at = static_cast<std::size_t>(i);
        const CaptionVerdict verdict = judge_caption(caption(at), labels[at]);
        const std::lock_guard lock(mutex);
        result.object += verdict.object;
        result.material += verdict.material;
        result.object_or_material += verdict.object || verdict.material;
        result.both += verdict.object && verdict.material;
        result.material_name += verdict.material_name;
        result.object_and_name += verdict.object && verdict.material_name;
        progress.update(++done);
    });
    if (interrupted()) throw Interrupted("while generating captions");
    for (double* part : {&result.object, &result.material, &result.object_or_material, &result.both,
                         &result.material_name, &result.object_and_name})
        *part /= static_cast<double>(std::max<std::int64_t>(result.count, 1));
    return result;
}

}  // namespace

LabeledImages draw_held_out(std::uint64_t seed, std::int64_t count, int views_each, int lights,
                            int threads) {
    std::vector<TrainingLight> all_lights =
        make_training_lights(mix_bits(seed + 1), lights, threads);
    const ExampleSource source(make_view_pool(true, shape_variants - training_variants, views_each,
                                              mix_bits(seed + 2), threads),
                               std::move(all_lights), mix_bits(seed + 3));
    LabeledImages images = draw_labeled(source, count, threads);
    if (interrupted()) throw Interrupted("while rendering the held-out images");
    return images;
}

RetrievalAccuracy measure_retrieval(const Clip& clip, const LabeledImages& labeled,
                                    int candidates) {
    const at::NoGradGuard no_grad;
    RetrievalAccuracy result;
    result.candidates = candidates;
    const at::Tensor own = at::arange(candidates);
    std::int64_t next = 0;
    for (;;) {
        const std::vector<std::int64_t> rows = distinct_images(labeled, next, candidates);
        if (static_cast<int>(rows.size()) < candidates) break;
        std::vector<std::string> captions;
        for (const std::int64_t row : rows)
            captions.push_back(plain_claim(labeled.labels[static_cast<std::size_t>(row)]).text());
        const at::Tensor images = labeled.pixel_values(rows) * .5 + .5;
        const at::Tensor cosines =
            clip.embed_images(images).mm(clip.embed_texts(captions).t()).cpu();
        const auto right = [&](std::int64_t dimension) {
            return cosines.argmax(dimension).eq(own).to(at::kDouble).mean().item<double>();
        };
        result.image_to_caption += right(1);
        result.caption_to_image += right(0);
        ++result.rounds;
    }
    if (result.rounds == 0) throw InputError("retrieval", "too few different images for one round");
    result.image_to_caption /= result.rounds;
    result.caption_to_image /= result.rounds;
    return result;
}

CaptionAccuracy measure_captions(const Captioner& captioner, const LabeledImages& images,
                                 int threads) {
    return judge_all(images.labels, threads, [&](std::size_t i) {
        return captioner.caption(images.images[static_cast<std::int64_t>(i)], {});
    });
}

LabeledModels draw_held_out_models(std::uint64_t seed, std::int64_t count, int views, int threads) {
    const std::int64_t light_count = std::clamp<std::int64_t>(count / 4, 1, 16);
    std::vector<TrainingLight> lights;
    Random light_random(mix_bits(seed + 1), 0);
    for (std::int64_t i = 0; i < light_count; ++i)
        lights.push_back(make_training_light(light_random, "studio"));
    std::vector<std::pair<std::string, int>> shapes;
    for (const ShapeClass& each : shape_classes())
        for (const int variant : shape_variants_of(each, true, shape_variants - training_variants))
            shapes.emplace_back(each.name, variant);

    LabeledModels models;
    models.views.resize(static_cast<std::size_t>(count));
    models.labels.resize(static_cast<std::size_t>(count));
    Progress progress("held-out models", count);
    std::int64_t done = 0;
    std::mutex mutex;
    run_workers(count, threads, [&](std::int64_t i) {
        Random random(mix_bits(seed + 2), static_cast<std::uint64_t>(i));
        const auto any_of = [&random](const auto& list) -> const auto& {
            return list[static_cast<std::size_t>(
                random.index(static_cast<std::int64_t>(list.size())))];
        };
        const auto& [shape_class, variant] = any_of(shapes);
        std::vector<ShapeView> sides =
            make_views(shape_class, variant, 2 * views, mix_bits(seed + 3 + i));
        // A close-up shows only a part of the shape, so whole views come first. It is rare that
        // almost all views are close-ups.
        std::stable_partition(sides.begin(), sides.end(),
                              [](const ShapeView& side) { return !side.close_up; });
        sides.resize(static_cast<std::size_t>(views));
        ExampleWish wish;
        wish.light = &any_of(lights);
        wish.plain_background = true;
        wish.part = "none";
        if (const auto parts = visible_parts(sides.front());
            !parts.empty() && random.chance(two_part_share))
            wish.part = sides.front().parts[any_of(parts)];
        const auto model = static_cast<std::size_t>(i);
        for (const ShapeView& side : sides) {
            Random same = random;  // the same materials from all sides
            Example example = draw_example(same, side, {}, wish);
            models.views[model].push_back((example.image * 255).round().to(at::kByte));
            models.labels[model] = std::move(example.labels);
        }
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    if (interrupted()) throw Interrupted("while rendering the held-out models");
    return models;
}

CaptionAccuracy measure_model_captions(const Captioner& captioner, const LabeledModels& models,
                                       int threads) {
    CaptionOptions options;
    options.beams = caption_beams;
    return judge_all(models.labels, threads, [&](std::size_t i) {
        return captioner.caption_together(models.views[i], options);
    });
}

void to_json(nlohmann::json& json, const RetrievalAccuracy& accuracy) {
    json = {{"rounds", accuracy.rounds},
            {"candidates", accuracy.candidates},
            {"picture_to_caption", rounded(accuracy.image_to_caption)},
            {"caption_to_picture", rounded(accuracy.caption_to_image)}};
}

void to_json(nlohmann::json& json, const CaptionAccuracy& accuracy) {
    json = {{"count", accuracy.count},
            {"object", rounded(accuracy.object)},
            {"material", rounded(accuracy.material)},
            {"object_or_material", rounded(accuracy.object_or_material)},
            {"both", rounded(accuracy.both)},
            {"material_name", rounded(accuracy.material_name)},
            {"object_and_name", rounded(accuracy.object_and_name)}};
}

}  // namespace item3d
