// The report of a plan: report.html with all its edits.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Returns the page. record: edit.json of the plan; edits: as they were run. Reads the images from
/// the edits' output folders.
std::string sequence_page(const nlohmann::json& record, const std::vector<EditRequest>& edits);

}  // namespace item3d
