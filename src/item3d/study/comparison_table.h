// Reader of a comparison's table.csv, which has one row for each case, method and seed.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// One run. Its folder has before.png, after.png and turntable.webp, which `item3d edit` writes.
struct ComparisonRow {
    std::string case_name, model, from, to, method, prior, seed;
    std::filesystem::path folder;
    /// Numbers of those columns of the paper's table that are not ratings: clip_global,
    /// clip_directional, seconds, peak_memory_bytes. A column that table.csv lacks is absent.
    std::map<std::string, double> scores;
};

/// Reads FOLDER/table.csv with at least the columns case, model, from, to, method, prior, seed,
/// folder (relative to FOLDER). With several priors, a method is "METHOD (PRIOR)". A row with
/// missing images, as after a failed run, is skipped and named in `skipped`. Throws InputError for
/// a table that is missing, lacks columns, or has no rows left.
std::vector<ComparisonRow> read_comparison(const std::filesystem::path& folder,
                                           std::vector<std::string>& skipped);

}  // namespace item3d
