// The choice of the surface region that an edit changes.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/networks/vocabulary.h"

#include <optional>
#include <string>

namespace item3d {

/// Returns the basic colour that an edit replaces by another: "red", if the sentences are "a red
/// barrel" and "a blue barrel". Only surface of that colour should change. Returns no value if the
/// sentences name no colours, or differ in more than colours.
std::optional<std::string> color_to_change(const EditPlan& plan, const PriorVocabulary& vocabulary);

/// Sets the scene's region and its views, and keeps only the materials that overlap the region. If
/// there are no selectors, the region is the surface of the colour to change, if that is a proper
/// part of the surface. If the selector is "all", or nothing distinguishes a part, there is no
/// region. Selectors that need the prior wait until scene.loading_prior is ready. Throws
/// InputError.
void choose_region(const EditRequest& edit, const PriorVocabulary& vocabulary, EditScene& scene);

}  // namespace item3d
