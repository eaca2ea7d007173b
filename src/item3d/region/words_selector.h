// A selector by words: what a network sees in pictures of the model.
#pragma once

#include "item3d/networks/vocabulary.h"
#include "item3d/region/selector.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// What `text.value` names ("the handle"). The readers' segmenter looks at pictures from all
/// around; without one, the prior's cross-attention is read instead, which is told. The answers are
/// gathered on the surface (surface_reading.h) and voted by patch (patch_vote.h). Notes what it
/// took, and warns where the answer is unsure. Throws InputError where there is no network, where
/// the vocabulary has no such thing, and where nothing of the kind is seen.
std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene);

/// The words of a phrase that a vocabulary does not have in either number ("horn", "horns").
struct UnknownWords {
    std::vector<std::string> all;  ///< in their order
    bool names_nothing = false;  ///< the thing itself is among them: "muzzle" of "the dark muzzle"
};
UnknownWords unknown_words(const PriorVocabulary& vocabulary, const std::string& phrase);

}  // namespace item3d
