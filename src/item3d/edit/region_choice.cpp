#include "item3d/edit/region_choice.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"
#include "item3d/metrics/color.h"
#include "item3d/region/region_readers.h"

#include <algorithm>

namespace item3d {
namespace {

/// Smallest and largest share of the surface for which a colour counts as a part of it.
constexpr double min_share = 0.03, largest_share = 0.97;

/// Returns the colour that a sentence names. Returns no value if it names none or several.
std::optional<KnownWord> only_color(const PriorVocabulary& vocabulary,
                                    const std::string& sentence) {
    const std::vector<KnownWord> named = vocabulary.named("colors", sentence);
    if (named.size() != 1 || !named.front().base_color) return std::nullopt;
    return named.front();
}

/// Returns the words of the sentence except articles and the words for the colour.
std::vector<std::string> other_words(const std::string& sentence, const KnownWord& color) {
    std::vector<std::string> words = prompt_words(sentence);
    std::erase_if(words, [&](const std::string& word) {
        return word == "a" || word == "an" || word == color.word ||
               std::find(color.spellings.begin(), color.spellings.end(), word) !=
                   color.spellings.end();
    });
    return words;
}

std::unique_ptr<Region> make_region(const RegionRequest& request, const EditScene& scene,
                                    const RegionReaders& readers) {
    const FieldSpace space(scene.model, scene.materials, scene.device);
    return std::make_unique<Region>(
        request, RegionScene{scene.model, scene.geometry, *scene.source_textures, space, &readers});
}

/// Returns the region of a colour; null if the colour covers nearly everything or hardly anything.
std::unique_ptr<Region> region_of_color(const std::string& color, const RegionRequest& request,
                                        const EditScene& scene, const RegionReaders& readers) {
    RegionRequest colored = request;
    colored.include = {"named=" + color};
    std::unique_ptr<Region> region;
    try {
        region = make_region(colored, scene, readers);
    } catch (const InputError&) {
        if (request.is_everything())
            note(
                fmt::format("no part of the base colour is {}, so the whole model is edited; "
                            "--region selects a part",
                            color));
        return nullptr;
    }
    if (region->share() < min_share && request.is_everything())
        note(
            fmt::format("only {:.1f} % of the base colour is {}, so the whole model is edited; "
                        "--region named={} selects only that part",
                        100 * region->share(), color, color));
    if (region->share() < min_share || region->share() > largest_share) return nullptr;
    note(fmt::format(
        "only the {} part is edited, {:.0f} % of the surface; --region all edits the whole model",
        color, 100 * region->share()));
    return region;
}

}  // namespace

std::optional<std::string> color_to_change(const EditPlan& plan,
                                           const PriorVocabulary& vocabulary) {
    const auto from = only_color(vocabulary, plan.from), to = only_color(vocabulary, plan.to);
    if (!from || !to || from->word == to->word) return std::nullopt;
    if (other_words(plan.from, *from) != other_words(plan.to, *to)) return std::nullopt;
    return basic_colors()[nearest_color(*from->base_color, basic_colors())].name;
}

void choose_region(const EditRequest& edit, const PriorVocabulary& vocabulary, EditScene& scene) {
    const EditPlan& plan = edit.plan;
    RegionRequest request{plan.region, plan.exclude, plan.feather};
    const bool is_automatic = plan.region.empty();
    if (is_automatic || plan.region == std::vector<std::string>{"all"}) request.include.clear();
    const auto color = is_automatic ? color_to_change(plan, vocabulary) : std::nullopt;
    if (request.is_everything() && !color) return;
    // These are the file's unmodified textures, for selectors by colour.
    scene.source_textures = std::make_unique<TexturedMaterials>(scene.model, scene.device);
    RegionReaders readers = load_readers(request, edit.segmenter, edit.prior, scene.device);
    if (needs_prior(request, readers.segmenter != nullptr)) readers.prior = scene.prior();
    readers.from = scene.from;
    readers.to = scene.to;
    if (color) scene.region = region_of_color(*color, request, scene, readers);
    if (!scene.region) {
        if (request.is_everything()) return;
        scene.region = make_region(request, scene, readers);
        note(fmt::format("the region covers {:.1f} % of the edited materials",
                         100 * scene.region->share()));
    }
    scene.region_views =
        std::make_unique<RegionViews>(scene.region->points(), scene.model, scene.geometry);
    scene.materials = scene.region->materials();
}

}  // namespace item3d
