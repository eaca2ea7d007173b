#include "item3d/networks/vocabulary.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/words.h"

#include <algorithm>
#include <set>

namespace item3d {
namespace {

/// Name that fits every object.
constexpr const char* any_object = "object";

/// Accuracy below which the warning says that the prior knows a word poorly.
constexpr double bad_accuracy = 0.5;

void add_once(std::vector<std::string>& words, const std::string& word) {
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
}

/// True for words that end the phrase of an image's subject and begin a phrase of its parts,
/// material or light.
bool begins_another_phrase(const std::string& word) {
    static const std::set<std::string> words{"a",   "an", "at",    "by",      "covered", "from",
                                             "has", "in", "made",  "of",      "on",      "that",
                                             "the", "to", "under", "wearing", "with"};
    return words.count(word) > 0;
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "\"" : ", \"") + word + "\"";
    return text;
}

KnownWord read_word(const std::string& kind, const nlohmann::json& entry) {
    KnownWord known;
    known.kind = kind;
    known.word = entry.at("word").get<std::string>();
    known.caption = entry.value("caption", "a " + known.word + " {o}");
    known.spellings = entry.value("spellings", std::vector<std::string>{known.word});
    known.accuracy = entry.value("accuracy", 0.0);
    known.taken_for = entry.value("most_confused_with", "");
    if (entry.contains("base_color")) {
        const auto color = entry.at("base_color").get<std::vector<float>>();
        if (color.size() == 3) known.base_color = Vec3(color[0], color[1], color[2]);
    }
    if (entry.contains("roughness")) known.roughness = entry.at("roughness").get<float>();
    return known;
}

}  // namespace

PriorVocabulary::PriorVocabulary(const nlohmann::json& prior_json, const std::string& subject) {
    try {
        all_words_ = prior_json.value("words", std::vector<std::string>{});
        std::sort(all_words_.begin(), all_words_.end());
        const nlohmann::json::json_pointer names("/segmenter/parts/names");
        if (prior_json.contains(names))
            for (const auto& [name, iou] : prior_json.at(names).items())
                part_names_.push_back(name);
        if (!prior_json.contains("vocabulary")) return;
        for (const auto& [kind, entries] : prior_json.at("vocabulary").items())
            for (const auto& entry : entries)
                words_.push_back(read_word(kind, entry));
    } catch (const nlohmann::json::exception& error) {
        throw InputError(subject, std::string("is not a valid prior.json: ") + error.what(),
                         "recreate it with `item3d prior evaluate`");
    }
}

PriorVocabulary PriorVocabulary::load(const std::filesystem::path& folder) {
    const auto file = folder / "prior.json";
    if (!std::filesystem::exists(file)) return {};
    const auto json = parse_json(read_text(file));
    if (!json.is_object())
        throw InputError(file.string(), "is not a JSON object",
                         "recreate it with `item3d prior evaluate`");
    return PriorVocabulary(json, file.string());
}

std::vector<KnownWord> PriorVocabulary::words_of(const std::string& kind) const {
    std::vector<KnownWord> result;
    for (const KnownWord& word : words_)
        if (word.kind == kind) result.push_back(word);
    return result;
}

bool PriorVocabulary::knows(const std::string& word) const {
    return open() || std::binary_search(all_words_.begin(), all_words_.end(), word);
}

bool PriorVocabulary::names_object(const std::string& word) const {
    return word == any_object ||
           std::any_of(words_.begin(), words_.end(), [&](const KnownWord& known) {
               return known.kind == "objects" &&
                      std::find(known.spellings.begin(), known.spellings.end(), word) !=
                          known.spellings.end();
           });
}

std::optional<std::size_t> PriorVocabulary::unknown_noun(
    const std::vector<std::string>& words) const {
    if (!knows(any_object)) return std::nullopt;
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (last && begins_another_phrase(words[i])) break;
        if (names_object(words[i])) return std::nullopt;
        if (!knows(words[i])) last = i;
    }
    return last;
}

std::string PriorVocabulary::reading(const std::string& prompt) const {
    std::vector<std::string> words = prompt_words(prompt);
    const std::optional<std::size_t> noun = unknown_noun(words);
    if (!noun) return prompt;
    words[*noun] = any_object;
    if (*noun > 0 && words[*noun - 1] == "a") words[*noun - 1] = "an";
    return fmt::format("{}", fmt::join(words, " "));
}

std::vector<KnownWord> PriorVocabulary::named(const std::string& kind,
                                              const std::string& prompt) const {
    const std::vector<std::string> prompt_has = prompt_words(prompt);
    std::vector<KnownWord> found;
    for (const KnownWord& known : words_) {
        if (known.kind != kind) continue;
        const bool is_named = std::any_of(
            known.spellings.begin(), known.spellings.end(), [&](const std::string& spelling) {
                return std::find(prompt_has.begin(), prompt_has.end(), spelling) !=
                       prompt_has.end();
            });
        if (is_named) found.push_back(known);
    }
    return found;
}

std::vector<std::string> PriorVocabulary::unknown_words(const std::string& prompt) const {
    std::vector<std::string> result;
    for (const std::string& word : prompt_words(prompt))
        if (!knows(word)) add_once(result, word);
    return result;
}

const KnownWord* PriorVocabulary::best_known(const std::string& spelling,
                                             bool shape_is_given) const {
    const KnownWord* best = nullptr;
    for (const KnownWord& known : words_) {
        if (shape_is_given && known.kind == "objects") continue;
        const auto& spellings = known.spellings;
        if (std::find(spellings.begin(), spellings.end(), spelling) == spellings.end()) continue;
        if (!best || known.accuracy > best->accuracy) best = &known;
    }
    return best;
}

std::vector<std::string> PriorVocabulary::weak_words(const std::string& prompt,
                                                     bool shape_is_given) const {
    std::vector<std::string> result;
    for (const std::string& word : prompt_words(prompt)) {
        const KnownWord* known = best_known(word, shape_is_given);
        if (known && known->accuracy < weak_accuracy) add_once(result, word);
    }
    return result;
}

std::string PriorVocabulary::warning(const std::string& prompt, bool shape_is_given) const {
    std::vector<std::string> unknown = unknown_words(prompt);
    const std::vector<std::string> weak = weak_words(prompt, shape_is_given);
    if (unknown.empty() && weak.empty()) return "";
    std::vector<std::string> bad, confusions, clauses;
    const std::vector<std::string> words = prompt_words(prompt);
    if (const auto noun = unknown_noun(words)) {
        clauses.push_back("reads " + listed({words[*noun]}) + " as " + listed({any_object}));
        std::erase(unknown, words[*noun]);
    }
    for (const std::string& word : weak) {
        const KnownWord& known = *best_known(word, shape_is_given);
        if (known.accuracy < bad_accuracy || known.taken_for.empty()) bad.push_back(word);
        if (!known.taken_for.empty())
            confusions.push_back(listed({word}) + " for " + listed({known.taken_for}));
    }
    if (!unknown.empty()) clauses.push_back("does not know " + listed(unknown));
    if (!bad.empty()) clauses.push_back("knows " + listed(bad) + " poorly");
    for (const std::string& confusion : confusions)
        clauses.push_back("sometimes takes " + confusion);
    std::string text = "the prior " + clauses.front();
    for (std::size_t i = 1; i < clauses.size(); ++i)
        text += (i + 1 < clauses.size() ? ", " : " and ") + clauses[i];
    return text + " (item3d prior info lists its words)";
}

}  // namespace item3d
