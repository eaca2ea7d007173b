// The selector by words, which a network looks for in renders of the model.
#pragma once

#include "item3d/networks/vocabulary.h"
#include "item3d/region/selector.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Selects `text.value` ("the handle"). The readers' segmenter reads renders from all sides;
/// without a segmenter, the prior's cross-attention is read instead, and a note says so. Results
/// are gathered on the surface (surface_reading.h) and voted on by patch (patch_vote.h). Prints a
/// note that describes the selection, and warns if it is uncertain. Throws InputError without a
/// network, for things outside of the vocabulary, and if nothing is found.
std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene);

/// Words of a phrase that a vocabulary lacks in singular and plural ("horn", "horns").
struct UnknownWords {
    std::vector<std::string> all;  ///< in the order of the phrase
    /// True if the noun itself is unknown: "muzzle" of "the dark muzzle".
    bool names_nothing = false;
};
UnknownWords unknown_words(const PriorVocabulary& vocabulary, const std::string& phrase);

}  // namespace item3d
