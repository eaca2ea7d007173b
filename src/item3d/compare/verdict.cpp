#include "item3d/compare/verdict.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/hub/find_prior.h"
#include "item3d/metrics/color.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/suite/cases.h"
#include "item3d/suite/look_by_clip.h"

#include <algorithm>
#include <optional>

namespace item3d {
namespace {

const std::vector<std::string> judged_kinds = {"colors", "materials", "patterns"};

/// Finds the word by its own name or by another spelling: "gold" for "golden".
std::optional<KnownWord> expected_word(const PriorVocabulary& vocabulary, const std::string& word) {
    for (const KnownWord& known : vocabulary.words()) {
        if (std::find(judged_kinds.begin(), judged_kinds.end(), known.kind) == judged_kinds.end())
            continue;
        const auto& spellings = known.spellings;
        if (known.word == word ||
            std::find(spellings.begin(), spellings.end(), word) != spellings.end())
            return known;
    }
    return std::nullopt;
}

/// Returns what to write instead of a word that the prior lacks.
std::string hint_for(const PriorVocabulary& vocabulary, const std::string& word) {
    std::vector<std::string> words, spellings;
    for (const KnownWord& known : vocabulary.words()) {
        if (std::find(judged_kinds.begin(), judged_kinds.end(), known.kind) == judged_kinds.end())
            continue;
        words.push_back(known.word);
        spellings.push_back(known.word);
        spellings.insert(spellings.end(), known.spellings.begin(), known.spellings.end());
    }
    const std::string similar = similar_name(word, spellings);
    if (!similar.empty()) return "did you mean '" + similar + "'?";
    return fmt::format("leave 'expect' out, or use one of {}", fmt::join(words, ", "));
}

std::string noun_of(const PriorVocabulary& vocabulary, const std::string& prompt) {
    const auto named = vocabulary.named("objects", prompt);
    return named.empty() ? "object" : named.front().word;
}

}  // namespace

void check_expectations(const CompareOptions& options) {
    for (const auto& prior : options.priors) {
        const PriorVocabulary vocabulary = PriorVocabulary::load(prior.folder);
        if (vocabulary.words().empty()) continue;
        for (const CompareCase& test : options.cases)
            if (!test.expect.empty() && !expected_word(vocabulary, test.expect))
                throw InputError(
                    fmt::format("case '{}'", test.name),
                    fmt::format(
                        "expects '{}', which is not a colour, material or pattern of the prior {}",
                        test.expect, prior.name),
                    hint_for(vocabulary, test.expect));
    }
}

nlohmann::json verdict_of(const CompareCase& test, const nlohmann::json& after,
                          const at::Tensor& images, const std::filesystem::path& prior) {
    if (test.expect.empty()) return nlohmann::json::object();
    const PriorVocabulary vocabulary = PriorVocabulary::load(prior);
    const auto expected = expected_word(vocabulary, test.expect);
    if (!expected) return nlohmann::json::object();
    std::string found;
    if (expected->kind == "colors") {
        const nlohmann::json& mean = after.at("base_color_linear");
        const auto colors = named_colors(vocabulary);
        if (colors.empty()) return nlohmann::json::object();
        found = colors[nearest_color(
                           Vec3(mean[0].get<float>(), mean[1].get<float>(), mean[2].get<float>()),
                           colors)]
                    .name;
    } else {
        const std::filesystem::path clip = find_in_prior(prior, "clip");
        if (clip.empty()) return nlohmann::json::object();
        found = look_by_clip(images, noun_of(vocabulary, test.to), Clip::load(clip), vocabulary,
                             judged_kinds);
    }
    return {{"found", found}, {"right", found == expected->word}};
}

}  // namespace item3d
