// Template captions of the training pictures.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/materials.h"

#include <string>
#include <vector>

namespace item3d {

/// "a photo of a wooden mug at sunset": picks a frame, a phrase of the material, a noun, and a
/// phrase of the light (one of `light_phrases`, which may be ""). One caption in eight says
/// "object".
std::string make_caption(Random& random, const std::vector<std::string>& nouns,
                         const std::vector<std::string>& material_phrases,
                         const std::vector<std::string>& light_phrases);

/// Puts "an" for "a" before vowels.
std::string mend_articles(const std::string& text);

/// A word of the captions and how often it comes.
struct WordCount {
    std::string word;
    std::int64_t count;
};
/// All words that training captions are made of, commonest first, from `draws` captions.
std::vector<WordCount> caption_vocabulary(std::uint64_t seed, int draws = 60000);

}  // namespace item3d
