// A file of several edits, which are made one after the other.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <vector>

namespace item3d {

/// The settings of each edit, under the names that edit.json has them: of {"edits": [{"from": ...,
/// "to": ..., "region": [...]}, ...]}. Throws InputError for a file that is none such.
std::vector<nlohmann::json> read_plan_file(const std::filesystem::path& path);

/// One edit of a plan.
struct PlannedEdit {
    std::filesystem::path model;   ///< the user's, or what the edit before made of it
    std::filesystem::path output;  ///< a folder below the plan's
    nlohmann::json settings;
    bool is_begun = false;  ///< goes on from its checkpoint
};

/// Makes each edit by `edit`, which returns its edit.json, in the folders OUTPUT/1, OUTPUT/2, ...;
/// then writes the last one's model, report.html, which shows all, and edit.json ({"edits"}) to
/// OUTPUT. resume: edits that are done, as their settings say, are not made again. Returns
/// edit.json.
nlohmann::json run_plan(const std::filesystem::path& model, const std::filesystem::path& output,
                        const std::vector<nlohmann::json>& edits, bool resume,
                        const std::function<nlohmann::json(const PlannedEdit&)>& edit);

}  // namespace item3d
