#include "item3d/region/words_selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"
#include "item3d/region/attention_reading.h"
#include "item3d/region/patch_vote.h"
#include "item3d/region/region_readers.h"

#include <algorithm>
#include <set>

namespace item3d {
namespace {

constexpr int segmenter_pixels = 192;
constexpr float enough_probability = 0.4f;
/// Mean probability of the selection below which it is uncertain.
constexpr double sure_probability = 0.6;
/// Margin over another part's mean probability below which the selection is uncertain.
constexpr double clearly_more = 0.05;
/// Attention above which a point is selected, in standard deviations above the mean.
constexpr float enough_attention = 1.25f;

constexpr const char* look = "check it with item3d region before an edit";

void check_words(const SelectorText& text, const PriorVocabulary& vocabulary) {
    const UnknownWords unknown = unknown_words(vocabulary, text.value);
    if (unknown.all.empty()) return;
    const std::string list = fmt::format("\"{}\"", fmt::join(unknown.all, "\", \""));
    if (unknown.names_nothing)
        throw InputError(text.whole, "the prior does not know " + list,
                         "item3d prior info lists the words that it knows; or use view=, sphere= "
                         "or named=");
    warn(fmt::format("{}: the prior does not know {}", text.whole, list));
}

bool same_in_either_number(const std::string& word, const std::string& other) {
    return word == other || word + "s" == other || word == other + "s";
}

/// Returns the phrase, and all parts that it does not name. These parts compete with it.
std::vector<std::string> with_other_parts(const std::string& phrase,
                                          const PriorVocabulary& vocabulary) {
    std::vector<std::string> prompts{phrase};
    const std::vector<std::string> said = prompt_words(phrase);
    for (const std::string& name : vocabulary.part_names())
        if (std::none_of(said.begin(), said.end(), [&](const std::string& word) {
                return same_in_either_number(word, name);
            }))
            prompts.push_back("the " + name);
    return prompts;
}

/// Returns the segmenter's selection, compared with other parts at the same points.
std::unique_ptr<Selector> ask_segmenter(const SelectorText& text, const RegionScene& scene) {
    const Segmenter& segmenter = *scene.readers->segmenter;
    segmenter.warn_of_lost_words(text.whole, text.value);
    const std::vector<std::string> prompts =
        with_other_parts(text.value, scene.readers->vocabulary);
    const SurfaceReading reading = read_surface(
        scene, segmenter_pixels,
        [&](const ModelView& view) { return segmenter.masks(view.image, prompts)[0]; });
    PatchVote vote = vote_by_patch(scene, reading, reading.values[0], enough_probability);
    if (vote.taken == 0)
        throw InputError(text.whole, "nothing was found on the model",
                         fmt::format("the highest probability is {:.0f} %, but {:.0f} % is needed; "
                                     "try other words, or use view= or sphere=",
                                     100 * vote.highest, 100 * enough_probability));
    std::size_t likeliest = 0;
    double other = 0;
    for (std::size_t i = 1; i < prompts.size(); ++i) {
        const double mean =
            reading.values[static_cast<std::int64_t>(i)].index({vote.inside}).mean().item<double>();
        if (mean > other) likeliest = i, other = mean;
    }
    const std::string line =
        fmt::format("{}: found on {:.1f} % of the visible surface, mean probability {:.0f} %",
                    text.whole, 100 * vote.taken, 100 * vote.mean);
    if (other > vote.mean + clearly_more)
        warn(fmt::format("{}: uncertain, \"{}\" has {:.0f} % there; {}", line, prompts[likeliest],
                         100 * other, look));
    else if (vote.mean < sure_probability)
        warn(fmt::format("{}: uncertain; {}", line, look));
    else
        note(line);
    return std::move(vote.selector);
}

std::unique_ptr<Selector> ask_attention(const SelectorText& text, const RegionScene& scene) {
    const SurfaceReading reading = read_attention(scene, *scene.readers->prior, text.value);
    PatchVote vote = vote_by_patch(scene, reading, reading.values[0], enough_attention);
    if (vote.taken == 0)
        throw InputError(text.whole,
                         "the prior's attention to these words is the same everywhere on the model",
                         "give a segmenter with --segmenter, or choose another selector");
    warn(fmt::format(
        "{}: found on {:.1f} % of the visible surface, {:.1f} standard deviations above the mean, "
        "by the prior's cross-attention because there is no segmenter; this is often wrong, {}",
        text.whole, 100 * vote.taken, vote.mean, look));
    return std::move(vote.selector);
}

}  // namespace

UnknownWords unknown_words(const PriorVocabulary& vocabulary, const std::string& phrase) {
    static const std::set<std::string> prepositions{"at", "by", "from", "in",    "made", "of",
                                                    "on", "to", "that", "under", "with"};
    const auto is_known = [&](const std::string& word) {
        const std::string other =
            word.ends_with("s") ? word.substr(0, word.size() - 1) : word + "s";
        return vocabulary.unknown_words(word).empty() || vocabulary.unknown_words(other).empty();
    };
    UnknownWords unknown;
    bool has_thing = false;
    for (const std::string& word : prompt_words(phrase)) {
        // The noun is the last word before a preposition.
        has_thing = has_thing || prepositions.count(word) > 0;
        const bool known = word == "part" || word == "parts" || is_known(word);
        if (!has_thing) unknown.names_nothing = !known;
        if (!known && std::find(unknown.all.begin(), unknown.all.end(), word) == unknown.all.end())
            unknown.all.push_back(word);
    }
    return unknown;
}

std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene) {
    const RegionReaders* readers = scene.readers;
    if (readers == nullptr || (!readers->segmenter && !readers->prior))
        throw InputError(text.whole, "needs a segmenter or a prior, but neither is available",
                         "give one with --segmenter, or choose another selector");
    const at::NoGradGuard no_grad;
    check_words(text, readers->vocabulary);
    return readers->segmenter ? ask_segmenter(text, scene) : ask_attention(text, scene);
}

}  // namespace item3d
