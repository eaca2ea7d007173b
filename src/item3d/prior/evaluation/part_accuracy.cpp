#include "item3d/prior/evaluation/part_accuracy.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace item3d {
namespace {

struct Mean {
    double sum = 0;
    int count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    /// Mean, rounded to four places; 0 without values.
    double value() const { return count > 0 ? std::round(sum / count * 10000) / 10000 : 0; }
};

using Means = std::map<std::string, Mean>;

nlohmann::json means_json(const Means& means) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [name, mean] : means)
        json[name] = {{"iou", mean.value()}, {"asked", mean.count}};
    return json;
}

/// Returns names and IoUs, the worst first.
nlohmann::json worst_first(const Means& means) {
    std::vector<std::pair<std::string, double>> all;
    for (const auto& [name, mean] : means)
        all.emplace_back(name, mean.value());
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.second < b.second; });
    return all;
}

double iou(const at::Tensor& found, const at::Tensor& wanted) {
    const auto both = (found * wanted).sum().item<double>();
    const auto either = (found + wanted).clamp_max(1).sum().item<double>();
    return either > 0 ? both / either : 1;
}

/// Draws the name of a part of any class. Returns "" if the object has this part.
std::string absent_part(Random& random, const PartLabels& labels) {
    const auto& nouns = all_part_nouns();
    const std::string& noun =
        nouns[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(nouns.size())))];
    return has_named(labels, noun) ? "" : noun;
}

/// Prompt for an image, with the kind of the prompt.
struct PartQuestion {
    enum class Kind { part, object, material, absent } kind;
    std::string prompt;
    std::uint32_t parts;
};

std::vector<PartQuestion> questions_about(const PartLabels& labels, Random& random) {
    using Kind = PartQuestion::Kind;
    std::vector<PartQuestion> questions{{Kind::object, labels.nouns[0], whole_object(labels)}};
    for (const std::string& name : named_parts(labels))
        questions.push_back({Kind::part, name, parts_named(labels, name)});
    if (labels.own && !labels.own_phrases.empty())
        questions.push_back({Kind::material, labels.own_phrases[0] + " part", labels.own});
    if (const std::string noun = absent_part(random, labels); !noun.empty())
        questions.push_back({Kind::absent, noun, 0});
    return questions;
}

bool is_new_class(const std::string& name) {
    return shape_classes()[static_cast<std::size_t>(shape_class_index(name))].held_out;
}

}  // namespace

PartImages draw_held_out_parts(std::uint64_t seed, std::int64_t count, int threads) {
    constexpr int lights = 48, views_each = 4;
    std::vector<TrainingLight> all_lights =
        make_training_lights(mix_bits(seed + 1), lights, threads);
    const ExampleSource source(make_view_pool(true, shape_variants - training_variants, views_each,
                                              mix_bits(seed + 2), threads, part_image_size),
                               std::move(all_lights), mix_bits(seed + 3));
    PartImages images = draw_part_images(source, count, threads);
    if (interrupted()) throw Interrupted("while rendering the held-out images");
    return images;
}

nlohmann::json measure_parts(const Segmenter& segmenter, const PartImages& images) {
    const at::NoGradGuard no_grad;
    Means words, classes;
    Mean all, new_classes, object, material, absent;
    Progress progress("parts", images.count());
    for (std::int64_t i = 0; i < images.count(); ++i) {
        if (interrupted()) throw Interrupted("while measuring the parts");
        const PartLabels& labels = images.labels[static_cast<std::size_t>(i)];
        Random random(0x9a47, static_cast<std::uint64_t>(i));
        const auto questions = questions_about(labels, random);
        std::vector<std::string> prompts;
        for (const PartQuestion& question : questions)
            prompts.push_back(question.prompt);
        const at::Tensor masks =
            segmenter.masks(images.pixel_values({i}) * .5 + .5, prompts)[0].cpu().gt(.5).to(
                at::kFloat);
        for (std::size_t k = 0; k < questions.size(); ++k) {
            const PartQuestion& question = questions[k];
            const at::Tensor found = masks[static_cast<std::int64_t>(k)];
            const at::Tensor whole = images.mask(i, whole_object(labels));
            if (question.kind == PartQuestion::Kind::absent) {
                absent.add(found.sum().item<double>() / std::max(1.0, whole.sum().item<double>()));
                continue;
            }
            const double reached = iou(found, images.mask(i, question.parts));
            if (question.kind == PartQuestion::Kind::object) object.add(reached);
            if (question.kind == PartQuestion::Kind::material) material.add(reached);
            if (question.kind != PartQuestion::Kind::part) continue;
            words[question.prompt].add(reached);
            classes[labels.shape_class].add(reached);
            all.add(reached);
            if (is_new_class(labels.shape_class)) new_classes.add(reached);
        }
        progress.update(i + 1);
    }
    Mean of_words;
    for (const auto& [word, mean] : words)
        of_words.add(mean.sum / mean.count);
    return {{"pictures", images.count()},          {"part_iou", of_words.value()},
            {"part_iou_of_pictures", all.value()}, {"new_class_iou", new_classes.value()},
            {"object_iou", object.value()},        {"material_iou", material.value()},
            {"absent_marked", absent.value()},     {"worst", worst_first(words)},
            {"words", means_json(words)},          {"classes", means_json(classes)}};
}

nlohmann::json part_summary(const nlohmann::json& measured) {
    nlohmann::json summary = measured;
    nlohmann::json names = nlohmann::json::object();
    for (const auto& [name, word] : measured.at("words").items())
        names[name] = word.at("iou");
    summary["names"] = names;
    for (const char* member : {"worst", "words", "classes"})
        summary.erase(member);
    return summary;
}

}  // namespace item3d
