// The choice of the surface region that an edit changes.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/networks/vocabulary.h"

#include <optional>
#include <string>

namespace item3d {

/// Returns the basic colour that an edit from one colour to another replaces ("red", of "a red
/// barrel" to "a blue barrel"); only surface of that colour should change. Returns nothing where
/// the sentences name no colours, or differ in more than colours.
std::optional<std::string> color_to_change(const EditPlan& plan, const PriorVocabulary& vocabulary);

/// Sets the scene's region and its views, and keeps only materials that overlap it. Without
/// selectors the region is the surface of the colour to change, where that is a proper part of the
/// surface; with "all", or where nothing distinguishes a part, there is no region. Selectors that
/// need the prior wait until scene.loading_prior is ready. Throws InputError.
void choose_region(const EditRequest& edit, const PriorVocabulary& vocabulary, EditScene& scene);

}  // namespace item3d
