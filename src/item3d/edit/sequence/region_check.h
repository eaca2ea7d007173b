// A check of the regions of a plan's edits before the first edit starts.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Builds the regions that do not depend on textures (which earlier edits change), and parses the
/// selectors of the others. Logs which regions overlap. model: input of the first edit. Throws
/// InputError "PLAN: edit N: ..." for names that the model lacks, unusable images, points outside
/// of the model, and regions that are empty or that no camera sees.
void check_regions(const std::string& plan, const std::vector<EditRequest>& edits,
                   const Model& model);

/// Returns the name of an edit in messages: "PLAN: edit 2" for index 1.
std::string edit_name(const std::string& plan, std::size_t index);

}  // namespace item3d
