// HTML page of a comparison, index.html.
#pragma once

#include "item3d/compare/table.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Returns the page: the table of methods; for each case its sentences, and its model before and
/// after every run, side by side (cases with failures first, then by the lowest directional score);
/// and last the failures with their reasons. rows: of measured_run(), whose images are read from
/// `output`. command: as typed, for the footer.
std::string compare_page(const std::vector<nlohmann::json>& rows,
                         const std::filesystem::path& output, const std::string& command);

}  // namespace item3d
