// The selector by a prior's response to the change of an edit's sentences.
#pragma once

#include "item3d/region/selector.h"

#include <memory>

namespace item3d {

/// Selects where the predictions of the readers' prior under the two sentences differ most
/// (guidance/reading.h), gathered and voted as for words: more than twice the surface's mean. Notes
/// the selection and its contrast. Throws InputError where sentences or the prior are missing, and
/// where the difference is about uniform.
std::unique_ptr<Selector> select_auto(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
