#include "item3d/suite/cases.h"

#include "item3d/core/error.h"
#include "item3d/prior/data/captions.h"
#include "item3d/suite/models.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace item3d {
namespace {

std::string with_article(const std::string& words) {
    const bool vowel = std::string("aeiou").find(words.front()) != std::string::npos;
    return (vowel ? "an " : "a ") + words;
}

/// Returns the linear base colour of the prior's colour `word`.
Vec3 color_of(const PriorVocabulary& vocabulary, const std::string& word) {
    for (const KnownWord& known : vocabulary.words()) {
        if (known.kind == "colors" && known.word == word && known.base_color)
            return *known.base_color;
    }
    throw InputError("prior.json", "has no base colour for '" + word + "'",
                     "run item3d prior evaluate on the prior");
}

}  // namespace

std::string prompt_of(const std::string& look, const std::string& noun) {
    const std::size_t at = look.find("{o}");
    if (at != std::string::npos)
        return mend_articles(std::string(look).replace(at, std::string("{o}").size(), noun));
    return look.starts_with("covered") ? with_article(noun) + " " + look
                                       : with_article(look + " " + noun);
}

std::vector<SuiteCase> suite_cases(const std::vector<std::string>& nouns) {
    const std::vector<std::vector<std::pair<std::string, std::string>>> colors = {
        {{"white", "red"}, {"red", "blue"}, {"blue", "yellow"}, {"yellow", "black"}},
        {{"white", "green"}, {"green", "purple"}, {"purple", "orange"}, {"orange", "white"}},
        {{"gray", "pink"}, {"pink", "brown"}, {"brown", "cyan"}, {"cyan", "gray"}}};
    struct Change {
        std::string from, to, word;
    };
    const std::vector<std::vector<Change>> materials = {
        {{"red", "golden", "gold"}, {"blue", "marble", "marble"}},
        {{"brown", "silver", "silver"}, {"white", "stone", "stone"}},
        {{"white", "wooden", "wood"}, {"gray", "covered in grass", "grass"}}};
    std::vector<SuiteCase> cases;
    for (std::size_t i = 0; i < nouns.size(); ++i) {
        for (const auto& [from, to] : colors[i % colors.size()]) {
            cases.push_back({"colors", nouns[i], from, to, to});
        }
        for (const auto& [from, to, word] : materials[i % materials.size()]) {
            cases.push_back({"materials", nouns[i], from, to, word});
        }
    }
    for (const auto& [noun, from, to] :
         {std::tuple{"mug", "red and white striped", "blue and white striped"},
          std::tuple{"cow", "green and white striped", "purple and white striped"}}) {
        if (std::find(nouns.begin(), nouns.end(), noun) == nouns.end()) continue;
        cases.push_back({"stripes", noun, from, to, ""});
    }
    return cases;
}

std::vector<SuiteCase> prior_suite_cases(const std::vector<std::string>& nouns,
                                         const PriorVocabulary& vocabulary) {
    const std::vector<KnownWord> colors = vocabulary.words_of("colors");
    if (colors.size() < 2)
        throw InputError("prior.json", "has fewer than two colours to start from",
                         "run item3d prior evaluate on the prior");
    std::vector<KnownWord> metals, materials;
    for (const KnownWord& known : vocabulary.words_of("materials"))
        (known.base_color ? metals : materials).push_back(known);
    struct Group {
        std::string name;
        std::vector<KnownWord> words;
        std::size_t each;    ///< number for each noun
        std::size_t stride;  ///< step through the words: neighbours in the list are similar
        std::size_t next = 0;
    };
    std::vector<Group> groups{{"colors", colors, 4, 5},
                              {"metals", metals, 2, 1},
                              {"materials", materials, 2, 7},
                              {"patterns", vocabulary.words_of("patterns"), 2, 5}};
    std::size_t source = 0;
    std::vector<SuiteCase> cases;
    for (const std::string& noun : nouns) {
        for (Group& group : groups) {
            // A stride that has a common factor with the number of words would skip words.
            while (std::gcd(group.stride, std::max<std::size_t>(group.words.size(), 1)) > 1)
                ++group.stride;
            for (std::size_t i = 0; i < group.each && !group.words.empty(); ++i) {
                const KnownWord& target =
                    group.words[group.next++ * group.stride % group.words.size()];
                if (colors[source % colors.size()].word == target.word) ++source;
                cases.push_back({group.name, noun, colors[source++ % colors.size()].word,
                                 target.caption, target.word});
            }
        }
    }
    return cases;
}

std::vector<NamedColor> named_colors(const PriorVocabulary& vocabulary) {
    std::vector<NamedColor> colors;
    for (const KnownWord& known : vocabulary.words_of("colors")) {
        if (!known.base_color) continue;
        const Vec3 c = *known.base_color;
        colors.push_back(
            {known.word, Vec3(linear_to_srgb(c.x), linear_to_srgb(c.y), linear_to_srgb(c.z))});
    }
    return colors;
}

Model source_model(const SuiteCase& test, const Model& mesh, const PriorVocabulary& vocabulary) {
    if (test.group != "stripes") return plain_model(mesh, color_of(vocabulary, test.source));
    const std::string first = test.source.substr(0, test.source.find(' '));
    return striped_model(mesh, color_of(vocabulary, first), color_of(vocabulary, "white"), 1, 5);
}

}  // namespace item3d
