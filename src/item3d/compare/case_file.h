// The entries of a file of cases, before they are interpreted.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Returns a JSON list with an element for each case. For a file that ends in .csv, each element is
/// an object of strings. Throws InputError that names the file and the place for a file that has no
/// rows, is not UTF-8, is not JSON, or is no list. Throws it also for a case that has a column or
/// key twice, where - and _ are equal.
nlohmann::json read_case_entries(const std::filesystem::path& file);

}  // namespace item3d
