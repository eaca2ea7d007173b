#include "item3d/prior/data/instructions.h"

#include "item3d/prior/data/captions.h"

#include <algorithm>

namespace item3d {
namespace {

const std::string& pick_one(Random& random, const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(from.size())))];
}

/// Returns "golden" for "golden {o}".
std::string adjective_of(const std::string& phrase) {
    return phrase.substr(0, phrase.find(" {o}"));
}

}  // namespace

std::string instruction_for_object(Random& random, const std::vector<std::string>& nouns,
                                   const std::vector<std::string>& phrases) {
    const std::string noun = random.chance(.125) ? "object" : pick_one(random, nouns);
    const std::string& phrase = pick_one(random, phrases);
    const std::string thing = mend_articles("a " + with_noun(phrase, noun));
    const double form = random.uniform();
    if (form < .6 && phrase.ends_with(" {o}"))
        return (form < .4 ? "make it " : "make the " + noun + " ") + adjective_of(phrase);
    return form < .8 ? "turn it into " + thing : "make it " + thing;
}

std::string instruction_for_part(Random& random, const std::string& part,
                                 const std::vector<std::string>& phrases) {
    const std::string phrase = pick_one(random, adjective_phrases(phrases));
    return random.chance(.5) ? "make the " + part + " " + adjective_of(phrase)
                             : "give it " + part_with_article(part, phrase);
}

}  // namespace item3d
