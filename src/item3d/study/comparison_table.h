// The table of a comparison: table.csv, one row for each case, method and seed.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// A run. Its folder has before.png, after.png and turntable.webp, as `item3d edit` leaves them.
struct ComparisonRow {
    std::string case_name, model, from, to, method, prior, seed;
    std::filesystem::path folder;
    /// Numbers of the paper's other columns, where the table has them: clip_global,
    /// clip_directional, seconds, peak_memory_bytes.
    std::map<std::string, double> scores;
};

/// Reads FOLDER/table.csv with at least the columns case, model, from, to, method, prior, seed,
/// folder (relative to FOLDER). Where there are several priors, a method is "METHOD (PRIOR)". Rows
/// whose pictures are missing (a method failed) are left out and named in `skipped`. Throws
/// InputError for a table that is missing, has other columns, or has no rows left.
std::vector<ComparisonRow> read_comparison(const std::filesystem::path& folder,
                                           std::vector<std::string>& skipped);

}  // namespace item3d
