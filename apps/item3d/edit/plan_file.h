// A file of several edits, which are made one after the other.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <vector>

namespace item3d {

/// The settings of each edit, under the names that edit.json has them: of {"edits": [{"from": ...,
/// "to": ..., "region": [...]}, ...]}. Throws InputError for a file that is none such.
std::vector<nlohmann::json> read_plan_file(const std::filesystem::path& path);

}  // namespace item3d
