#include "item3d/prior/data/labels.h"

#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/materials/colors.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace item3d {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& text) {
    return std::find(list.begin(), list.end(), text) != list.end();
}

const std::string& any_of(Random& random, const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(from.size())))];
}

/// Sorts colours: "white and red striped {o}" -> "red and white striped {o}". Their order is random
/// and not visible in the image.
std::string in_alphabetic_order(const std::string& phrase) {
    const auto at = phrase.find(" and ");
    if (at == std::string::npos) return phrase;
    const auto end = phrase.find(' ', at + 5);
    const std::string first = phrase.substr(0, at), second = phrase.substr(at + 5, end - at - 5);
    return std::min(first, second) + " and " + std::max(first, second) + phrase.substr(end);
}

std::string plainest_phrase(const ProceduralMaterial& material) {
    // The finish of a plain colour is hard to see in 64 pixels.
    if (material.kind == "plain") return material.color + " {o}";
    static const std::set<std::string> symmetric{"striped", "checkered", "zigzag", "tartan"};
    if (symmetric.count(material.kind)) return in_alphabetic_order(material.phrases.front());
    return material.phrases.front();
}

const std::vector<std::string>& frames() {
    static const std::vector<std::string> all{"a photo of ", "a picture of ", "an image of ",
                                              "a 3d render of "};
    return all;
}

std::string without_frame(const std::string& caption) {
    for (const std::string& frame : frames())
        if (caption.starts_with(frame)) return caption.substr(frame.size());
    return caption;
}

/// Returns the kinds of the materials and patterns in a phrase, or else its plain colours.
std::set<std::string> names_in(const std::string& phrase) {
    std::set<std::string> words, kinds, colors;
    std::istringstream stream(phrase);
    for (std::string word; stream >> word;)
        words.insert(word);
    for (const MaterialWord& known : material_words())
        for (const std::string& spelling : known.spellings)
            if (words.count(spelling)) kinds.insert(known.word);
    for (const PlainColor& color : plain_colors())
        if (words.count(color.name)) colors.insert(color.name);
    return kinds.empty() ? colors : kinds;
}

}  // namespace

ImageLabels labels_of(const ShapeClass& shape, const ProceduralMaterial& material,
                      const TrainingLight& light, const PartMaterial* part) {
    ImageLabels labels;
    const auto add = [&](const std::string& phrase) {
        if (!contains(labels.phrases, phrase)) labels.phrases.push_back(phrase);
    };
    const std::string plainest = plainest_phrase(material);
    if (part) {
        const std::string own = part_with_article(part->noun, plainest_phrase(part->material));
        add(plainest + " with " + own);
        for (const std::string& phrase : adjective_phrases(part->material.phrases))
            add(plainest + " with " + part_with_article(part->noun, phrase));
        add("{o} with " + own);
    }
    add(plainest);
    for (const auto* phrases : {&material.phrases, &material.also_true})
        for (const std::string& phrase : *phrases)
            add(phrase);
    labels.nouns = shape.held_out ? std::vector<std::string>{"object"} : shape.nouns;
    for (const std::string& phrase : light.phrases)
        if (!phrase.empty() && !contains(labels.lights, phrase)) labels.lights.push_back(phrase);
    return labels;
}

std::string ClaimedLabels::text(const std::string& frame) const {
    std::string thing = phrase.empty() ? "{o}" : phrase;
    thing.replace(thing.find("{o}"), 3, noun);
    return frame + mend_articles("a " + thing + light);
}

bool holds(const ClaimedLabels& claim, const ImageLabels& labels) {
    return (claim.phrase.empty() || contains(labels.phrases, claim.phrase)) &&
           (claim.noun == "object" || contains(labels.nouns, claim.noun)) &&
           (claim.light.empty() || contains(labels.lights, claim.light));
}

ClaimedLabels plain_claim(const ImageLabels& labels) {
    return {labels.phrases.front(), labels.nouns.front(), ""};
}

ClaimedLabels whole_claim(const ImageLabels& labels) {
    ClaimedLabels claim = plain_claim(labels);
    for (const std::string& phrase : labels.phrases)
        if (labels.phrases.front().starts_with(phrase + " with ")) claim.phrase = phrase;
    return claim;
}

ClaimedLabels draw_claim(Random& random, const ImageLabels& labels) {
    ClaimedLabels claim = plain_claim(labels);
    if (random.chance(.3)) claim.phrase = any_of(random, labels.phrases);
    if (random.chance(.2)) claim.noun = any_of(random, labels.nouns);
    if (random.chance(.1)) claim.noun = "object";
    if (claim.noun != "object" && random.chance(.06)) claim.phrase.clear();
    if (!labels.lights.empty() && random.chance(.3)) claim.light = any_of(random, labels.lights);
    return claim;
}

const std::string& draw_frame(Random& random) {
    static const std::string none;
    return random.chance(.1) ? any_of(random, frames()) : none;
}

CaptionVerdict judge_caption(const std::string& caption, const ImageLabels& labels) {
    std::istringstream stream(without_frame(caption));
    std::vector<std::string> words;
    for (std::string word; stream >> word;)
        if (word != "a" && word != "an") words.push_back(word);
    std::set<std::string> nouns{"object"};
    for (const ShapeClass& shape : shape_classes())
        nouns.insert(shape.nouns.begin(), shape.nouns.end());
    CaptionVerdict verdict;
    std::string phrase;
    bool named = false;  // true after a noun; a later noun is a part: "a snowman with a red hat"
    for (const std::string& word : words) {
        const bool is_object = !named && nouns.count(word) > 0;
        if (is_object) verdict.object = contains(labels.nouns, word);
        named = named || is_object;
        phrase += (phrase.empty() ? "" : " ") + (is_object ? "{o}" : word);
    }
    for (const std::string& each : labels.phrases) {
        // Removes articles from the phrase, too: "{o} with a flame pattern" contains one.
        std::istringstream parts(each);
        std::string bare;
        for (std::string word; parts >> word;)
            if (word != "a") bare += (bare.empty() ? "" : " ") + word;
        verdict.material = verdict.material || bare == phrase;
    }
    const std::set<std::string> names = names_in(phrase);
    // Phrases about a part's material come first in the list, before those about the whole object.
    const auto whole =
        std::find(labels.phrases.begin(), labels.phrases.end(), whole_claim(labels).phrase);
    verdict.material_name =
        verdict.material ||
        (!names.empty() && std::any_of(whole, labels.phrases.end(), [&](const std::string& each) {
            return names_in(each) == names;
        }));
    return verdict;
}

void to_json(nlohmann::json& json, const ImageLabels& labels) {
    json = nlohmann::json::array({labels.phrases, labels.nouns, labels.lights});
}

void from_json(const nlohmann::json& json, ImageLabels& labels) {
    json.at(0).get_to(labels.phrases);
    json.at(1).get_to(labels.nouns);
    json.at(2).get_to(labels.lights);
}

}  // namespace item3d
