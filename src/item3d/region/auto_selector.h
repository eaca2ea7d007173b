// The selector by a prior's response to the change of an edit's sentences.
#pragma once

#include "item3d/region/selector.h"

#include <memory>

namespace item3d {

/// Selects the surface where the prior's predictions under the two sentences differ by more than
/// twice the mean difference (guidance/reading.h). Differences are gathered and voted on as in
/// select_words(). Prints a note: the selected share of the visible surface, and the ratio of the
/// mean difference there to the mean difference of all. Throws InputError where sentences or the
/// prior are missing, and where the difference is about uniform.
std::unique_ptr<Selector> select_auto(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
