// A look at the regions of a plan's edits before the first of them takes its minutes.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Makes those regions that do not depend on textures, which earlier edits change, and reads the
/// selectors of the others. Notes which regions overlap. model: that of the first edit. Throws
/// InputError "PLAN: edit N: ..." for names that the model has not, pictures that cannot be used,
/// places outside of the model, and regions in which nothing is, or that no camera sees.
void check_regions(const std::string& plan, const std::vector<EditRequest>& edits,
                   const Model& model);

/// The place of an edit in messages: "PLAN: edit 2", of index 1.
std::string edit_name(const std::string& plan, std::size_t index);

}  // namespace item3d
