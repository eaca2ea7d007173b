// Vocabulary of a prior, from the prior.json beside its weights, and warnings about prompts.
#pragma once

#include "item3d/core/math.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Accuracy, from 0 to 1, below which the user is warned about a word.
inline constexpr double weak_accuracy = 0.8;

struct KnownWord {
    std::string kind;     ///< "colors", "materials", "patterns", "lights" or "objects"
    std::string word;     ///< "gold"
    std::string caption;  ///< caption template of the word: "a golden {o}"
    std::vector<std::string> spellings;  ///< prompt words with this meaning: "gold", "golden"
    double accuracy = 0;    ///< accuracy of the diffusion classifier on held-out shapes, 0 .. 1
    std::string taken_for;  ///< word that it is most often mistaken for; may be empty
    std::optional<Vec3> base_color;  ///< linear RGB, for colours and metals
    std::optional<float> roughness;  ///< middle of a metal's roughness range in the training data
};

/// Contents of a prior.json. Without one (a Stable Diffusion folder) no word is unknown or weak.
class PriorVocabulary {
  public:
    PriorVocabulary() = default;
    explicit PriorVocabulary(const nlohmann::json& prior_json, const std::string& subject);
    /// Reads FOLDER/prior.json; returns an empty vocabulary if there is no such file. Throws
    /// InputError if the file is invalid.
    static PriorVocabulary load(const std::filesystem::path& folder);

    /// True if the prior has no vocabulary. Every word then counts as known.
    bool open() const { return all_words_.empty(); }
    const std::vector<KnownWord>& words() const { return words_; }
    /// Object parts ("handle") that the prior's segmenter was measured on.
    const std::vector<std::string>& part_names() const { return part_names_; }
    std::vector<KnownWord> words_of(const std::string& kind) const;
    /// Returns the words of `kind` in the prompt, in the vocabulary's order.
    std::vector<KnownWord> named(const std::string& kind, const std::string& prompt) const;

    /// Returns the prompt's words that training captions lack, in the prompt's order, each once.
    std::vector<std::string> unknown_words(const std::string& prompt) const;
    /// Returns the prompt's words that the prior was trained on with an accuracy below
    /// weak_accuracy. If the prior gets the shape's depth (shape_is_given), names of objects hardly
    /// matter, and are not returned.
    std::vector<std::string> weak_words(const std::string& prompt, bool shape_is_given) const;
    /// Returns the prompt with an unknown noun ("a zigzag rabbit") replaced by "object", if the
    /// prior knows that word: the sub-word tokens of an unknown word blur the meaning of the
    /// others.
    std::string reading(const std::string& prompt) const;
    /// Returns one line for the user that names all unknown and weak words, or "".
    std::string warning(const std::string& prompt, bool shape_is_given) const;

  private:
    bool knows(const std::string& word) const;
    bool names_object(const std::string& word) const;
    /// Returns the index of the prompt's word that reading() replaces.
    std::optional<std::size_t> unknown_noun(const std::vector<std::string>& words) const;
    /// Returns the most accurate meaning of a prompt's word; null if none is measured.
    const KnownWord* best_known(const std::string& spelling, bool shape_is_given) const;

    std::vector<KnownWord> words_;
    std::vector<std::string> part_names_;
    std::vector<std::string> all_words_;  ///< sorted; all words of the training captions
};

}  // namespace item3d
