// Runs the suite's edits as a user would, judges them by numbers, and shows every picture.
#pragma once

#include "item3d/suite/cases.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

struct SuiteOptions {
    std::filesystem::path output;
    std::filesystem::path prior;
    std::map<std::string, std::filesystem::path> meshes;  ///< by noun
    std::uint64_t seed = 0;
    bool resume = false;       ///< goes on with the edits that are in `output` already
    int picture_pixels = 384;  ///< side of the views in the edits' reports
};

/// Runs each edit in a folder of its own below `output`, with the prior's defaults, and writes
/// suite.json and suite.html there: {"totals", "seed", "edits"}. A colour is right when the
/// surface's mean base colour is nearest, in CIELAB, to the named one among the prior's; a metal
/// when the surface's mean metallic is more than 0.6; a material or pattern when the prior's own
/// CLIP, where it has one, sees it among all of its materials and patterns. Stripes are judged by
/// the detail that is kept. Throws what an edit throws.
nlohmann::json run_edit_suite(const std::vector<SuiteCase>& cases, const SuiteOptions& options);

/// {group: {"edits", "right"?, "kept", "seconds", "seconds_most"}, "edits", "peak_memory_bytes"} of
/// the results. Means, but for the last two.
nlohmann::json suite_totals(const std::vector<nlohmann::json>& results);

}  // namespace item3d
