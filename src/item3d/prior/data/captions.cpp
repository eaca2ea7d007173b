#include "item3d/prior/data/captions.h"

#include "item3d/prior/data/lights.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/text/clip_tokenizer.h"

#include <algorithm>
#include <map>
#include <sstream>

namespace item3d {
namespace {

const std::string& pick(Random& random, const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(from.size())))];
}

}  // namespace

void fill_in(std::string& text, const std::string& place, const std::string& by) {
    if (const auto at = text.find(place); at != std::string::npos)
        text.replace(at, place.size(), by);
}

std::string mend_articles(const std::string& text) {
    std::istringstream words(text);
    std::string word, result;
    bool article = false;
    while (words >> word) {
        if (article) {
            const bool vowel = std::string("aeiou").find(word[0]) != std::string::npos;
            result += vowel ? " an" : " a";
        }
        article = word == "a" || word == "an";
        if (!article) result += " " + word;
    }
    if (article) result += " a";
    return result.empty() ? result : result.substr(1);
}

std::string with_noun(std::string phrase, const std::string& noun) {
    const auto at = phrase.find("{o}");
    if (at != std::string::npos) phrase.replace(at, 3, noun);
    return phrase;
}

std::vector<std::string> adjective_phrases(const std::vector<std::string>& phrases) {
    std::vector<std::string> result;
    for (const std::string& phrase : phrases)
        if (phrase.ends_with("{o}")) result.push_back(phrase);
    return result;
}

std::string part_with_article(const std::string& noun, const std::string& phrase) {
    const bool uncounted = noun.ends_with("s") || noun == "icing" || noun == "cargo";
    return mend_articles((uncounted ? "" : "a ") + with_noun(phrase, noun));
}

const std::vector<std::string>& part_nouns(const std::string& shape_class) {
    static const std::map<std::string, std::vector<std::string>> known = [] {
        std::map<std::string, std::vector<std::string>> all;
        constexpr int enough = 8;  // number of variants; some variants have parts that others lack
        for (const ShapeClass& shape : shape_classes()) {
            std::vector<std::string>& nouns = all[shape.name];
            for (int variant = 0; variant < enough; ++variant)
                for (const ShapePart& part : make_shape(shape.name, variant).parts)
                    if (!part.noun.empty() &&
                        std::find(nouns.begin(), nouns.end(), part.noun) == nouns.end())
                        nouns.push_back(part.noun);
        }
        return all;
    }();
    return known.at(shape_class);
}

namespace {

/// Parts of a caption in their order. All but `thing` may be empty.
struct Sentence {
    std::string early_light, frame, thing, light;

    std::string text() const { return mend_articles(early_light + " " + frame + thing + light); }
};

/// Returns "a wooden chair with a red seat", or one of the two materials alone.
std::string thing_said(Random& random, const ImageWords& words, const std::string& noun) {
    // Some captions omit the material, so that nouns get a meaning of their own.
    if (random.chance(.05)) return "a " + noun;
    if (!words.part || random.chance(.08))
        return "a " + with_noun(pick(random, words.phrases), noun);
    const PartWords& part = *words.part;
    const std::string rest = "a " + with_noun(pick(random, adjective_phrases(words.phrases)), noun);
    const std::string own =
        part_with_article(part.noun, pick(random, adjective_phrases(part.phrases)));
    const double order = random.uniform();
    return order < .7    ? rest + " with " + own
           : order < .82 ? rest + " that has " + own
                         : own + " on " + rest;
}

}  // namespace

std::string make_caption(Random& random, const ImageWords& words) {
    static const std::vector<std::string> frames{"",
                                                 "",
                                                 "",
                                                 "",
                                                 "",
                                                 "a photo of ",
                                                 "a photo of ",
                                                 "a 3d render of ",
                                                 "an image of ",
                                                 "a picture of "};
    // A second noun is rarer than the first.
    std::string noun =
        words.nouns.size() > 1 && random.chance(.25) ? pick(random, words.nouns) : words.nouns[0];
    if (random.chance(.12)) noun = "object";
    Sentence sentence;
    sentence.thing = thing_said(random, words, noun);
    sentence.frame = pick(random, frames);
    sentence.light = random.chance(.85) ? pick(random, words.lights) : std::string();
    if (sentence.frame.empty() && random.chance(.15))
        std::swap(sentence.light, sentence.early_light);

    // An overlong sentence loses its least important words.
    for (std::string* less : {&sentence.frame, &sentence.early_light, &sentence.light}) {
        if (ClipTokenizer::split_words(sentence.text()).size() <= longest_caption) break;
        less->clear();
    }
    return sentence.text();
}

std::vector<WordCount> caption_vocabulary(std::uint64_t seed, int draws) {
    std::vector<std::string> lights{""};
    for (const std::string& kind : light_kinds())
        lights.insert(lights.end(), light_phrases(kind).begin(), light_phrases(kind).end());
    std::map<std::string, std::int64_t> counts;
    const auto& classes = shape_classes();
    for (int i = 0; i < draws; ++i) {
        Random random(seed, static_cast<std::uint64_t>(i));
        const ShapeClass& shape = classes[static_cast<std::size_t>(i) % classes.size()];
        if (shape.held_out) continue;
        ImageWords words{shape.nouns, make_material(random).phrases, lights, {}};
        const auto& parts = part_nouns(shape.name);
        if (!parts.empty() && random.chance(.5))
            words.part = PartWords{pick(random, parts), make_material(random).phrases};
        for (const std::string& word : ClipTokenizer::split_words(make_caption(random, words)))
            ++counts[word];
    }
    std::vector<WordCount> result;
    for (const auto& [word, count] : counts)
        result.push_back({word, count});
    std::stable_sort(result.begin(), result.end(),
                     [](const WordCount& a, const WordCount& b) { return a.count > b.count; });
    return result;
}

}  // namespace item3d
