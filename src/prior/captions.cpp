#include "item3d/prior/captions.h"

#include "item3d/models/clip_tokenizer.h"
#include "item3d/prior/shapes.h"

#include <algorithm>
#include <map>
#include <sstream>

namespace item3d {
namespace {

const std::string& pick(Random& random, const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(from.size())))];
}

std::string with_noun(std::string phrase, const std::string& noun) {
    const auto at = phrase.find("{o}");
    if (at != std::string::npos) phrase.replace(at, 3, noun);
    return phrase;
}

}  // namespace

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

std::string make_caption(Random& random, const std::vector<std::string>& nouns,
                         const std::vector<std::string>& material_phrases,
                         const std::vector<std::string>& light_phrases) {
    static const std::vector<std::string> frames{"a ",
                                                 "a ",
                                                 "a ",
                                                 "a ",
                                                 "a ",
                                                 "a photo of a ",
                                                 "a photo of a ",
                                                 "a 3d render of a ",
                                                 "an image of a ",
                                                 "a picture of a "};
    // A second noun is rarer than the first.
    std::string noun = nouns.size() > 1 && random.chance(.25) ? pick(random, nouns) : nouns[0];
    if (random.chance(.12)) noun = "object";
    // Now and then nothing about the material, so that nouns stand on their own too.
    const std::string thing =
        random.chance(.05) ? noun : with_noun(pick(random, material_phrases), noun);
    const std::string frame = pick(random, frames);
    const std::string light = random.chance(.85) ? pick(random, light_phrases) : std::string();
    return mend_articles(frame + thing + light);
}

std::vector<WordCount> caption_vocabulary(std::uint64_t seed, int draws) {
    static const std::vector<std::string> lights{
        "",          " in a studio", " under studio light", " in bright light", " at sunset",
        " at night", " in the dark", " on an overcast day", " at noon",         " in the sun"};
    std::map<std::string, std::int64_t> counts;
    const auto& classes = shape_classes();
    for (int i = 0; i < draws; ++i) {
        Random random(seed, static_cast<std::uint64_t>(i));
        const ShapeClass& shape = classes[static_cast<std::size_t>(i) % classes.size()];
        if (shape.held_out) continue;
        const ProceduralMaterial material = make_material(random);
        const std::string caption = make_caption(random, shape.nouns, material.phrases, lights);
        for (const std::string& word : ClipTokenizer::split_words(caption))
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
