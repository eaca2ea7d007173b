// Suite of test edits: runs them with default settings, scores them, and shows all images.
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
    bool resume = false;     ///< true: resume with the finished edits in `output`
    int image_pixels = 384;  ///< edge of the views in the edits' reports
};

/// Runs each edit in its own folder below `output`, with the prior's defaults, and writes
/// suite.json and suite.html there: {"totals", "seed", "edits"}. A colour is right if it is the one
/// of the prior's colours that is nearest, in CIELAB, to the surface's mean base colour. A metal is
/// right if the surface's mean metallic is more than 0.6. A material or pattern is right if the
/// prior's own CLIP, if any, chooses it among all of its materials and patterns. Stripes are scored
/// by the preserved detail. Throws like an edit.
nlohmann::json run_edit_suite(const std::vector<SuiteCase>& cases, const SuiteOptions& options);

/// Returns {"groups": {group: {"edits", "right"?, "kept", "seconds", "seconds_most"}}, "edits",
/// "peak_memory_bytes"} of the results: "edits" and "right" are counts, "seconds_most" and
/// "peak_memory_bytes" maxima, "kept" and "seconds" means.
nlohmann::json suite_totals(const std::vector<nlohmann::json>& results);

}  // namespace item3d
