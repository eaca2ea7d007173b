// The plan file, which lists several edits that are made one after another.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <vector>

namespace item3d {

/// Reads the settings of each edit. They have the same names as in edit.json: {"edits": [{"from":
/// ..., "to": ..., "region": [...]}, ...]}. Throws InputError for an invalid file.
std::vector<nlohmann::json> read_plan_file(const std::filesystem::path& path);

}  // namespace item3d
