// The report of a plan, which is report.html with all its edits.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Returns the page. Reads the images from the edits' output folders. record: edit.json of the
/// plan; edits: the requests as they were run.
std::string sequence_page(const nlohmann::json& record, const std::vector<EditRequest>& edits);

}  // namespace item3d
