// Entries of a file of cases, before they are interpreted.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Returns a JSON list with an element for each case. For a file that ends in .csv, each element is
/// an object of strings. Throws InputError that names the file and the place: for a file that has
/// no rows, is not UTF-8, not JSON or no list, and for a column or key that a case has twice (- and
/// _ are equal).
nlohmann::json read_case_entries(const std::filesystem::path& file);

}  // namespace item3d
