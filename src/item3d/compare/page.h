// HTML page of a comparison, index.html.
#pragma once

#include "item3d/compare/table.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Returns the page. It begins with the table of methods. Then it shows, for each case, the
/// sentences, and the model before and after every run, side by side. Cases with failures come
/// first, then the others by their lowest directional score. The page ends with the failures and
/// their reasons. rows: from measured_run(), whose images are read from `output`; command: as
/// typed, for the footer.
std::string compare_page(const std::vector<nlohmann::json>& rows,
                         const std::filesystem::path& output, const std::string& command);

}  // namespace item3d
