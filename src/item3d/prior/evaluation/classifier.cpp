#include "item3d/prior/evaluation/classifier.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/materials/colors.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

namespace item3d {
namespace {

std::vector<VocabularyEntry> make_vocabulary() {
    std::vector<VocabularyEntry> all;
    for (const PlainColor& color : plain_colors()) {
        std::vector<std::string> spellings{color.name};
        if (color.name == "gray") spellings.emplace_back("grey");
        all.push_back({"colors",
                       color.name,
                       spellings,
                       "a " + color.name + " {o}",
                       {"plain", color.name, ""},
                       "",
                       "",
                       ""});
    }
    for (const MaterialWord& word : material_words())
        all.push_back({word.group, word.word, word.spellings, word.caption, word.wish, "", "",
                       word.colored_caption});
    // Captions also use another word for these lights, as in "in the dark" for the night.
    const std::map<std::string, std::string> others{
        {"night", "dark"}, {"noon", "sun"}, {"overcast", "cloudy"}};
    for (const std::string& kind : light_kinds()) {
        std::vector<std::string> spellings{kind};
        const auto other = others.find(kind);
        if (other != others.end()) spellings.push_back(other->second);
        all.push_back(
            {"lights", kind, spellings, "a {c} {o}" + light_phrases(kind)[0], {}, kind, "", ""});
    }
    for (const ShapeClass& shape : shape_classes())
        if (!shape.held_out && shape.name != "blob")
            all.push_back(
                {"objects", shape.name, shape.nouns, "a {c} {o}", {}, "", shape.name, ""});
    return all;
}

/// True if the prior was trained on every word of the entry's captions.
bool knows(const std::set<std::string>& words, const VocabularyEntry& entry) {
    if (words.empty()) return true;
    std::string caption = entry.caption;
    fill_in(caption, "{o}", entry.shape_class.empty() ? "" : entry.word);
    fill_in(caption, "{c}", "");
    const std::vector<std::string> needed = prompt_words(caption);
    return std::all_of(needed.begin(), needed.end(),
                       [&](const std::string& word) { return words.count(word) > 0; });
}

/// Number of correctly classified images of a word, and its most frequent confusions.
struct Outcome {
    int right = 0;
    int of_new_classes = 0, right_of_new_classes = 0;
    std::map<std::string, int> wrong;
};

double part_of(int right, int all) {
    return std::round(1000.0 * right / std::max(all, 1)) / 1000;
}

/// Returns the summary of one kind of words.
nlohmann::json kind_summary(const std::vector<Outcome>& outcomes, int images) {
    Outcome sum;
    for (const Outcome& each : outcomes) {
        sum.right += each.right;
        sum.of_new_classes += each.of_new_classes;
        sum.right_of_new_classes += each.right_of_new_classes;
    }
    nlohmann::json summary{
        {"words", outcomes.size()},
        {"accuracy", part_of(sum.right, static_cast<int>(outcomes.size()) * images)}};
    if (sum.of_new_classes > 0)
        summary["on_new_classes"] = part_of(sum.right_of_new_classes, sum.of_new_classes);
    return summary;
}

/// Returns the spellings that the prior was trained on.
std::vector<std::string> known_spellings(const VocabularyEntry& entry,
                                         const std::set<std::string>& words) {
    std::vector<std::string> known;
    for (const std::string& spelling : entry.spellings)
        if (words.empty() || words.count(spelling)) known.push_back(spelling);
    return known;
}

/// True if one of the two materials includes the other, as wood includes oak.
bool one_names_both(const MaterialWish& a, const MaterialWish& b) {
    return !a.kind.empty() && a.kind == b.kind && (a.color.empty() || b.color.empty());
}

/// Returns the index `truth` and at most `rivals` other indices, drawn at random.
std::vector<std::size_t> draw_candidates(Random& random,
                                         const std::vector<VocabularyEntry>& entries,
                                         std::size_t truth, int rivals) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < entries.size(); ++i)
        if (i != truth && !one_names_both(entries[i].material, entries[truth].material))
            others.push_back(i);
    const std::size_t wanted = std::min(others.size(), static_cast<std::size_t>(rivals));
    std::vector<std::size_t> chosen{truth};
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto left = static_cast<std::int64_t>(others.size() - i);
        std::swap(others[i], others[i + static_cast<std::size_t>(random.index(left))]);
        chosen.push_back(others[i]);
    }
    return chosen;
}

class Measurement {
  public:
    Measurement(const DiffusionModel& pipeline, const std::vector<ShapeView>& views,
                const MeasureOptions& options)
        : pipeline_(pipeline), options_(options), views_(views) {
        for (const std::string& kind : light_kinds()) {
            Random random(options.seed, 77 + lights_.size());
            lights_[kind] = make_training_light(random, kind);
        }
        for (const PlainColor& color : plain_colors())
            if (options.words.empty() || options.words.count(color.name))
                colors_.push_back(color.name);
        if (colors_.empty())
            throw InputError("the prior's words", "contain no colour to measure with");
        Random random(options.seed, 76);
        lights_["plain"] = make_training_light(random, "plain");
    }

    /// Measures all words of one kind against each other.
    std::vector<Outcome> measure(const std::vector<VocabularyEntry>& entries, Progress& progress,
                                 std::int64_t& done) {
        std::vector<Outcome> outcomes(entries.size());
        const auto jobs = static_cast<std::int64_t>(entries.size()) * options_.images;
        std::mutex mutex;
        run_workers(jobs, options_.threads, [&](std::int64_t job) {
            const auto truth = static_cast<std::size_t>(job / options_.images);
            const Answer answer = classify(entries, truth, job);
            const bool right = answer.candidate == truth;
            const std::lock_guard lock(mutex);
            outcomes[truth].right += right;
            outcomes[truth].of_new_classes += answer.new_class;
            outcomes[truth].right_of_new_classes += answer.new_class && right;
            if (!right) ++outcomes[truth].wrong[entries[answer.candidate].word];
            progress.update(++done);
        });
        return outcomes;
    }

  private:
    struct Answer {
        std::size_t candidate;
        bool new_class;  ///< true if the image's class is new
    };

    const ShapeView& pick_view(Random& random, const std::string& shape_class) const {
        for (;;) {
            const ShapeView& view = views_[static_cast<std::size_t>(
                random.index(static_cast<std::int64_t>(views_.size())))];
            if (shape_class.empty() ||
                shape_classes()[static_cast<std::size_t>(view.shape_class)].name == shape_class)
                return view;
        }
    }

    /// Draws two colours that look different.
    std::pair<std::string, std::string> draw_colors(Random& random) const {
        const auto any = [&] {
            return colors_[static_cast<std::size_t>(
                random.index(static_cast<std::int64_t>(colors_.size())))];
        };
        const std::string first = any();
        constexpr int tries = 64;  // a prior may know only one colour
        std::string second = any();
        for (int i = 0; i < tries && colors_alike(first, second); ++i)
            second = any();
        return {first, second};
    }

    Answer classify(const std::vector<VocabularyEntry>& entries, std::size_t truth,
                    std::int64_t job) const {
        const VocabularyEntry& entry = entries[truth];
        Random random(options_.seed,
                      mix_bits(std::uint64_t{1} + truth) + static_cast<std::uint64_t>(job));
        const ShapeView& view = pick_view(random, entry.shape_class);
        ExampleWish wish;
        wish.plain_background = true;
        wish.light = &lights_.at(entry.light.empty() ? "plain" : entry.light);
        wish.material = entry.material;
        const auto [color, second] = draw_colors(random);
        const bool in_any_color = !entry.colored_caption.empty();
        if (wish.material.kind.empty()) wish.material = {"plain", color, ""};
        if (in_any_color) wish.material = {entry.material.kind, color, second};
        wish.part = "none";
        const ShapeClass& shape = shape_classes()[static_cast<std::size_t>(view.shape_class)];
        const std::string noun = shape.held_out ? "object" : shape.nouns[0];

        const std::vector<std::size_t> candidates =
            draw_candidates(random, entries, truth, options_.rivals);
        std::vector<std::string> captions;
        for (const std::size_t candidate : candidates) {
            const VocabularyEntry& other = entries[candidate];
            std::string caption = in_any_color && !other.colored_caption.empty()
                                      ? other.colored_caption
                                      : other.caption;
            fill_in(caption, "{o}", other.shape_class.empty() ? noun : other.word);
            fill_in(caption, "{c}", color);
            fill_in(caption, "{d}", second);
            captions.push_back(mend_articles(caption));
        }
        const Example example = draw_example(random, view, {}, wish);
        const auto rows = static_cast<std::int64_t>(captions.size());
        const at::Tensor image = example.image.permute({2, 0, 1}).unsqueeze(0) * 2 - 1;
        const at::Tensor latents = pipeline_.encode_image(image).expand({rows, -1, -1, -1});
        const TextEmbedding text = pipeline_.encode_text(captions);
        at::Tensor condition;
        // If the shape is given, the noun hardly matters. Objects are therefore classified without
        // the shape.
        if (takes_shape(pipeline_)) {
            condition = shape_condition(example.cells.to(at::kFloat).unsqueeze(0),
                                        pipeline_.condition_channels());
            if (!entry.shape_class.empty()) condition = at::zeros_like(condition);
        }
        at::Tensor loss = at::zeros({rows});
        auto generator = at::detail::createCPUGenerator(random.bits());
        for (std::int64_t t = 50; t < 1000; t += 100) {
            const auto noise =
                at::randn({1, latents.size(1), latents.size(2), latents.size(3)}, generator)
                    .expand_as(latents);
            const at::Tensor times = at::full({rows}, t, at::kLong);
            const at::Tensor noisy = pipeline_.schedule().add_noise(latents, noise, times);
            const at::Tensor guess = pipeline_.predict_noise(noisy, times, text, condition);
            loss += (guess - noise).square().mean({1, 2, 3});
        }
        return {candidates[static_cast<std::size_t>(loss.argmin().item<std::int64_t>())],
                shape.held_out};
    }

    const DiffusionModel& pipeline_;
    MeasureOptions options_;
    const std::vector<ShapeView>& views_;
    std::map<std::string, TrainingLight> lights_;
    std::vector<std::string> colors_;  ///< colours that the prior knows
};

}  // namespace

const std::vector<VocabularyEntry>& prior_vocabulary() {
    static const std::vector<VocabularyEntry> entries = make_vocabulary();
    return entries;
}

std::vector<ShapeView> held_out_views(const DiffusionModel& pipeline, std::uint64_t seed,
                                      int threads) {
    const int edge = pipeline.native_size();
    if (edge != 64 && edge != 128)
        throw InputError(
            "the prior",
            fmt::format("generates images of {} pixels, but an evaluation needs 64 or 128", edge),
            "use a prior of `item3d prior train`");
    return make_view_pool(true, shape_variants, 6, mix_bits(seed), threads, edge);
}

nlohmann::json measure_prior(const DiffusionModel& pipeline, const std::vector<ShapeView>& views,
                             const MeasureOptions& options) {
    std::vector<VocabularyEntry> all;
    for (const VocabularyEntry& entry : prior_vocabulary())
        if (knows(options.words, entry)) all.push_back(entry);
    std::vector<std::string> kinds;
    for (const VocabularyEntry& entry : all)
        if (kinds.empty() || kinds.back() != entry.kind) kinds.push_back(entry.kind);
    Measurement measurement(pipeline, views, options);
    Progress progress("measure", static_cast<std::int64_t>(all.size()) * options.images);
    std::int64_t done = 0;
    double right = 0;
    nlohmann::json vocabulary = nlohmann::json::object();
    nlohmann::json summaries = nlohmann::json::object();
    for (const std::string& kind : kinds) {
        std::vector<VocabularyEntry> entries;
        for (const VocabularyEntry& entry : all)
            if (entry.kind == kind) entries.push_back(entry);
        const std::vector<Outcome> outcomes = measurement.measure(entries, progress, done);
        if (interrupted()) throw Interrupted("nothing was written");
        nlohmann::json list = nlohmann::json::array();
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const double accuracy = static_cast<double>(outcomes[i].right) / options.images;
            right += accuracy;
            nlohmann::json word{{"word", entries[i].word},
                                {"spellings", known_spellings(entries[i], options.words)},
                                {"caption", entries[i].caption},
                                {"accuracy", std::round(accuracy * 1000) / 1000}};
            const auto worst =
                std::max_element(outcomes[i].wrong.begin(), outcomes[i].wrong.end(),
                                 [](const auto& a, const auto& b) { return a.second < b.second; });
            if (worst != outcomes[i].wrong.end()) word["most_confused_with"] = worst->first;
            for (const auto* colors : {&plain_colors(), &metal_colors()})
                for (const PlainColor& color : *colors)
                    if (color.name == entries[i].word && (kind == "colors" || kind == "materials"))
                        word["base_color"] = {color.linear.x, color.linear.y, color.linear.z};
            for (const PlainColor& metal : metal_colors())
                if (metal.name == entries[i].word) word["roughness"] = metal_roughness(metal.name);
            list.push_back(word);
        }
        vocabulary[kind] = list;
        summaries[kind] = kind_summary(outcomes, options.images);
    }
    return {{"vocabulary", vocabulary},
            {"kinds", summaries},
            {"accuracy", right / static_cast<double>(all.size())}};
}

}  // namespace item3d
