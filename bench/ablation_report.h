// What did the study find? A table, as JSON and as Markdown, and the pictures side by side.
#pragma once

#include "bench/ablation_edit.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace item3d {

/// Writes table.json, table.md and the sheets of all results into the output folder.
void write_ablation_report(const AblationOptions& options,
                           const std::vector<nlohmann::json>& results);

}  // namespace item3d
