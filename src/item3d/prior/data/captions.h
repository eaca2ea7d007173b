// Template captions of the training pictures.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/materials/materials.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// A part with a material of its own.
struct PartWords {
    std::string noun;                  ///< "handle", "wheels"
    std::vector<std::string> phrases;  ///< of its material: "red {o}"
};

/// Everything that a caption may say of a picture.
struct PictureWords {
    std::vector<std::string> nouns;    ///< of the object, the commonest first
    std::vector<std::string> phrases;  ///< of its material
    std::vector<std::string> lights;   ///< phrases of the light; may hold ""
    std::optional<PartWords> part;     ///< where one part differs from the rest
};

/// No caption has more words than that, as the tokenizer counts them.
inline constexpr std::size_t longest_caption = 22;
/// What prompts are cut to: the longest caption and the tokens at its ends.
inline constexpr int text_length = longest_caption + 2;

/// "a photo of a wooden mug with a red handle at sunset", in many orders and words. One caption in
/// eight says "object" for the noun.
std::string make_caption(Random& random, const PictureWords& words);

/// Those of the phrases that end with the noun, so that they also suit a part.
std::vector<std::string> adjective_phrases(const std::vector<std::string>& phrases);
/// "a red handle", "red wheels", "pink icing".
std::string part_with_article(const std::string& noun, const std::string& phrase);
/// The phrase with the noun in its place.
std::string with_noun(std::string phrase, const std::string& noun);

/// Names of the parts that shapes of a class may have.
const std::vector<std::string>& part_nouns(const std::string& shape_class);

/// Puts "an" for "a" before vowels.
std::string mend_articles(const std::string& text);
/// Puts `by` for the first `place` in the text, as "{o}", if there is one.
void fill_in(std::string& text, const std::string& place, const std::string& by);

/// A word of the captions and how often it comes.
struct WordCount {
    std::string word;
    std::int64_t count;
};
/// All words that training captions are made of, commonest first, from `draws` captions.
std::vector<WordCount> caption_vocabulary(std::uint64_t seed, int draws = 60000);

}  // namespace item3d
