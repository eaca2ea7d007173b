// Entries of a file of cases, before they are interpreted.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Returns a JSON list with an element for each case: of a file that ends in .csv, an object of
/// strings for each row. Throws InputError that names the file and the place: a file without rows,
/// not UTF-8, not JSON, no list, and a column or key that a case has twice (- and _ are equal).
nlohmann::json read_case_entries(const std::filesystem::path& file);

}  // namespace item3d
