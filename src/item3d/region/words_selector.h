// A selector by words: what a segmentation network sees in pictures of the model.
#pragma once

#include "item3d/region/region.h"
#include "item3d/region/selector.h"

#include <filesystem>
#include <memory>

namespace item3d {

/// What `text.value` names ("the handle"). The scene's segmenter looks at pictures from all around;
/// its answers are gathered on the surface, by how squarely each place is seen, and voted by patch
/// (surface_patches.h), so that borders are the model's own; within a patch that is in part named,
/// the border is the network's. Notes what it took and how sure it is. Throws InputError where
/// there is no segmenter, and where it sees nothing of the kind.
std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene);

/// The network in `folder`, where a selector of the request is by words; null else, and for an
/// empty path. Throws InputError.
std::unique_ptr<Segmenter> load_wanted_segmenter(const RegionRequest& request,
                                                 const std::filesystem::path& folder,
                                                 at::Device device);

}  // namespace item3d
