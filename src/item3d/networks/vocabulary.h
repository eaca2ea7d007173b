// What a prior knows, from the prior.json beside its weights, and what it says about a prompt.
#pragma once

#include "item3d/core/math.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Words measured below this part of right answers are warned about.
inline constexpr double weak_accuracy = 0.8;

struct KnownWord {
    std::string kind;     ///< "colors", "materials", "patterns", "lights" or "objects"
    std::string word;     ///< "gold"
    std::string caption;  ///< how to say it: "a golden {o}"
    std::vector<std::string> spellings;  ///< words of prompts that mean it: "gold", "golden"
    double accuracy = 0;                 ///< of the diffusion classifier on held-out shapes, 0 .. 1
    std::string taken_for;               ///< the word it is most often taken for; may be empty
    std::optional<Vec3> base_color;      ///< linear RGB, for colours and metals
    std::optional<float> roughness;      ///< of metals: the middle of what the prior has seen
};

/// The content of a prior.json. Priors without one (a Stable Diffusion folder) know everything as
/// far as we can tell: no word of theirs is unknown or weak.
class PriorVocabulary {
  public:
    PriorVocabulary() = default;
    explicit PriorVocabulary(const nlohmann::json& prior_json, const std::string& subject);
    /// Reads FOLDER/prior.json; an empty vocabulary when there is none. Throws InputError when it
    /// can't be understood.
    static PriorVocabulary load(const std::filesystem::path& folder);

    /// True when nothing is known about what the prior knows.
    bool open() const { return all_words_.empty(); }
    const std::vector<KnownWord>& words() const { return words_; }
    /// Parts of objects ("handle") that the prior's segmenter was measured on.
    const std::vector<std::string>& part_names() const { return part_names_; }
    std::vector<KnownWord> words_of(const std::string& kind) const;
    /// Words of `kind` that the prompt names, in the order of the vocabulary.
    std::vector<KnownWord> named(const std::string& kind, const std::string& prompt) const;

    /// Words of the prompt, in its order and each once, that the prior was never trained on.
    std::vector<std::string> unknown_words(const std::string& prompt) const;
    /// Words that it was trained on but tells from others too seldom (below weak_accuracy). Where
    /// the shape is given by a depth, names of objects carry no weight and are left out.
    std::vector<std::string> weak_words(const std::string& prompt, bool shape_is_given) const;
    /// The prompt as the prior can take it in. It was never shown the pieces of a word that it does
    /// not know, and they blur what the others say: where the thing that is talked about has such a
    /// name ("a zigzag rabbit"), the word becomes "object", in so far as the prior knows that.
    std::string reading(const std::string& prompt) const;
    /// One line for the user that names all of that, or nothing.
    std::string warning(const std::string& prompt, bool shape_is_given) const;

  private:
    bool knows(const std::string& word) const;
    bool names_object(const std::string& word) const;
    /// Which of a prompt's words is read as "object".
    std::optional<std::size_t> unknown_noun(const std::vector<std::string>& words) const;
    /// The meaning of a prompt's word that is known best; null where none is measured.
    const KnownWord* best_known(const std::string& spelling, bool shape_is_given) const;

    std::vector<KnownWord> words_;
    std::vector<std::string> part_names_;
    std::vector<std::string> all_words_;  ///< sorted; every word of training captions
};

}  // namespace item3d
