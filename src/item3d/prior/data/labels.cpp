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

PictureFacts facts_of(const ShapeClass& shape, const ProceduralMaterial& material,
                      const TrainingLight& light, const PartMaterial* part) {
    PictureFacts facts;
    const auto add = [&](const std::string& phrase) {
        if (!contains(facts.phrases, phrase)) facts.phrases.push_back(phrase);
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
    facts.nouns = shape.held_out ? std::vector<std::string>{"object"} : shape.nouns;
    for (const std::string& phrase : light.phrases)
        if (!phrase.empty() && !contains(facts.lights, phrase)) facts.lights.push_back(phrase);
    return facts;
}

std::string PictureClaim::text(const std::string& frame) const {
    std::string thing = phrase.empty() ? "{o}" : phrase;
    thing.replace(thing.find("{o}"), 3, noun);
    return frame + mend_articles("a " + thing + light);
}

bool holds(const PictureClaim& claim, const PictureFacts& facts) {
    return (claim.phrase.empty() || contains(facts.phrases, claim.phrase)) &&
           (claim.noun == "object" || contains(facts.nouns, claim.noun)) &&
           (claim.light.empty() || contains(facts.lights, claim.light));
}

PictureClaim plain_claim(const PictureFacts& facts) {
    return {facts.phrases.front(), facts.nouns.front(), ""};
}

PictureClaim whole_claim(const PictureFacts& facts) {
    PictureClaim claim = plain_claim(facts);
    for (const std::string& phrase : facts.phrases)
        if (facts.phrases.front().starts_with(phrase + " with ")) claim.phrase = phrase;
    return claim;
}

PictureClaim draw_claim(Random& random, const PictureFacts& facts) {
    PictureClaim claim = plain_claim(facts);
    if (random.chance(.3)) claim.phrase = any_of(random, facts.phrases);
    if (random.chance(.2)) claim.noun = any_of(random, facts.nouns);
    if (random.chance(.1)) claim.noun = "object";
    if (claim.noun != "object" && random.chance(.06)) claim.phrase.clear();
    if (!facts.lights.empty() && random.chance(.3)) claim.light = any_of(random, facts.lights);
    return claim;
}

const std::string& draw_frame(Random& random) {
    static const std::string none;
    return random.chance(.1) ? any_of(random, frames()) : none;
}

CaptionVerdict judge_caption(const std::string& caption, const PictureFacts& facts) {
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
        if (is_object) verdict.object = contains(facts.nouns, word);
        named = named || is_object;
        phrase += (phrase.empty() ? "" : " ") + (is_object ? "{o}" : word);
    }
    for (const std::string& each : facts.phrases) {
        // "{o} with a flame pattern" contains an article.
        std::istringstream parts(each);
        std::string bare;
        for (std::string word; parts >> word;)
            if (word != "a") bare += (bare.empty() ? "" : " ") + word;
        verdict.material = verdict.material || bare == phrase;
    }
    const std::set<std::string> names = names_in(phrase);
    // A part's material precedes claims about the whole.
    const auto whole =
        std::find(facts.phrases.begin(), facts.phrases.end(), whole_claim(facts).phrase);
    verdict.material_name =
        verdict.material ||
        (!names.empty() && std::any_of(whole, facts.phrases.end(), [&](const std::string& each) {
            return names_in(each) == names;
        }));
    return verdict;
}

void to_json(nlohmann::json& json, const PictureFacts& facts) {
    json = nlohmann::json::array({facts.phrases, facts.nouns, facts.lights});
}

void from_json(const nlohmann::json& json, PictureFacts& facts) {
    json.at(0).get_to(facts.phrases);
    json.at(1).get_to(facts.nouns);
    json.at(2).get_to(facts.lights);
}

}  // namespace item3d
