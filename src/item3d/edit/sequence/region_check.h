// A check of the regions of a plan's edits before the first edit starts.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Checks the regions. Builds those that do not depend on textures, because earlier edits change
/// textures. Parses only the selectors of the others. Prints which regions overlap. model: the
/// model of the first edit. Throws InputError "PLAN: edit N: ..." for names that the model lacks,
/// unusable images, points outside of the model, and regions that are empty or that no camera sees.
void check_regions(const std::string& plan, const std::vector<EditRequest>& edits,
                   const Model& model);

/// Returns the name of an edit for messages: "PLAN: edit 2" for index 1.
std::string edit_name(const std::string& plan, std::size_t index);

}  // namespace item3d
