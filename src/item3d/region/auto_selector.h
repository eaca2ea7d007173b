// A selector by what an edit's sentences change in a prior's eyes.
#pragma once

#include "item3d/region/selector.h"

#include <memory>

namespace item3d {

/// Where the predictions of the readers' prior under the readers' two sentences differ most
/// (guidance/reading.h), gathered and voted as words are: more than twice as much as on average
/// over the surface. Notes what it took and by how much it stands out. Throws InputError where
/// sentences or the prior are missing, and where they differ about evenly all over the model.
std::unique_ptr<Selector> select_auto(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
