// Training of byte-pair encoding (Sennrich et al. 2016) on a closed vocabulary, for CLIP's
// tokenizer.
#pragma once

#include "item3d/prior/data/captions.h"
#include "item3d/text/clip_tokenizer.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Merges the most frequent pair of symbols until every word is a single token; ties go to the
/// first pair in byte order. Words are lower-case letters or digits. The ids belong, in this order,
/// to the 256 bytes, the same bytes at the end of a word, the merges in their order, and start and
/// end of text.
ClipTokenizer train_tokenizer(const std::vector<WordCount>& words, int max_length);

}  // namespace item3d
