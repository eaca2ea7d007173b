// A selector by words: what a segmentation network sees in pictures of the model.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// What `text.value` names ("the handle"). The scene's segmenter looks at pictures from all around;
/// its answers are gathered on the surface, by how squarely each place is seen, and voted by patch
/// (surface_patches.h), so that borders are the model's own; within a patch that is in part named,
/// the border is the network's. Notes what it took and how sure it is. Throws InputError where there
/// is no segmenter, and where it sees nothing of the kind.
std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
