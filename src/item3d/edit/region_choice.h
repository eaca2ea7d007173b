// Which part of the surface an edit changes.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/networks/vocabulary.h"

#include <optional>
#include <string>

namespace item3d {

/// The basic colour that an edit from one colour to another is about ("red", of "a red barrel" to
/// "a blue barrel"): only what has it is meant to change. Nothing where the sentences name no
/// colours, or differ in more than them.
std::optional<std::string> color_to_change(const EditPlan& plan, const PriorVocabulary& vocabulary);

/// Sets the scene's region and its views, and leaves the materials that have a part in it. Without
/// selectors it is what has the colour to change, if that is a part of the surface; with "all", or
/// where nothing is to be told apart, there is none. Selectors that ask the prior wait until
/// scene.loading_prior is done. Throws InputError.
void choose_region(const EditRequest& edit, const PriorVocabulary& vocabulary, EditScene& scene);

}  // namespace item3d
