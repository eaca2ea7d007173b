// Template captions of the training images.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/materials/materials.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Part of an object with a material of its own. In phrases, "{o}" stands for the noun.
struct PartWords {
    std::string noun;                  ///< "handle", "wheels"
    std::vector<std::string> phrases;  ///< phrases of the part's material: "red {o}"
};

/// Facts of an image that a caption may state.
struct ImageWords {
    std::vector<std::string> nouns;    ///< nouns of the object, the most frequent first
    std::vector<std::string> phrases;  ///< phrases of its material
    std::vector<std::string> lights;   ///< phrases of the light; "" is a caption without the light
    std::optional<PartWords> part;     ///< set if one part has a material of its own
};

/// Maximum length of a caption in tokens.
inline constexpr std::size_t longest_caption = 22;
/// Length that prompts are truncated to: the longest caption with its start and end tokens.
inline constexpr int text_length = longest_caption + 2;

/// Draws a caption such as "a photo of a wooden mug with a red handle at sunset" in one of many
/// wordings. One caption in eight uses the noun "object".
std::string make_caption(Random& random, const ImageWords& words);

/// Returns the phrases that end with the noun, such as "red {o}". Such phrases also suit a part.
std::vector<std::string> adjective_phrases(const std::vector<std::string>& phrases);
/// Returns a part with its article: "a red handle", "red wheels", "pink icing".
std::string part_with_article(const std::string& noun, const std::string& phrase);
/// Returns the phrase with the noun in place of "{o}".
std::string with_noun(std::string phrase, const std::string& noun);

/// Returns the names of the parts that shapes of a class may have.
const std::vector<std::string>& part_nouns(const std::string& shape_class);

/// Replaces "a" by "an" before vowels.
std::string mend_articles(const std::string& text);
/// Replaces the first occurrence of `place`, such as "{o}", in the text by `by`. A text without it
/// stays the same.
void fill_in(std::string& text, const std::string& place, const std::string& by);

/// Word of the captions and its number of occurrences.
struct WordCount {
    std::string word;
    std::int64_t count;
};
/// Draws `draws` training captions and returns all their words, the most frequent first.
std::vector<WordCount> caption_vocabulary(std::uint64_t seed, int draws = 60000);

}  // namespace item3d
