// Suite of test edits. It runs the edits with default settings, scores them, and shows all images.
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
    std::map<std::string, std::filesystem::path> meshes;  ///< meshes by noun
    std::uint64_t seed = 0;
    bool resume = false;     ///< true if finished edits in `output` are kept
    int image_pixels = 384;  ///< edge of the views in the edits' reports
};

/// Runs each edit in its own folder below `output`, with the prior's defaults, and writes
/// suite.json and suite.html there: {"totals", "seed", "edits"}. A colour is right if, of all the
/// prior's colours, it is nearest in CIELAB to the surface's mean base colour. A metal is right if
/// the surface's mean metallic is more than 0.6. A material or pattern is right if the prior's own
/// CLIP chooses it among all of the prior's materials and patterns. Without a CLIP, it is not
/// judged. Stripes are scored by the preserved detail. Throws like an edit.
nlohmann::json run_edit_suite(const std::vector<SuiteCase>& cases, const SuiteOptions& options);

/// Returns the totals of results: {"groups": {group: {"edits", "right"?, "kept", "seconds",
/// "seconds_most"}}, "edits", "peak_memory_bytes"}. "edits" and "right" are counts, "seconds_most"
/// and "peak_memory_bytes" are maxima, "kept" and "seconds" are means.
nlohmann::json suite_totals(const std::vector<nlohmann::json>& results);

}  // namespace item3d
