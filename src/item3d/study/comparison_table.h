// The table of a comparison: table.csv, one row for each case, method and seed.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// A run. Its folder has before.png, after.png and turntable.webp, as `item3d edit` leaves them.
struct ComparisonRow {
    std::string case_name, model, from, to, method, seed;
    std::filesystem::path folder;
    /// Numbers of the paper's other columns, where the table has them: clip_global,
    /// clip_directional, seconds, peak_memory_bytes.
    std::map<std::string, double> scores;
};

/// Cells of RFC 4180: separated by commas, quoted where they hold commas, quotes or line ends.
/// subject: what messages call it. Throws InputError for a quote that does not end.
std::vector<std::vector<std::string>> parse_csv(const std::string& text,
                                                const std::string& subject);

/// Reads FOLDER/table.csv with at least the columns case, model, from, to, method, seed, folder
/// (relative to FOLDER). Rows whose pictures are missing (a method failed) are left out and named
/// in `skipped`. Throws InputError for a table that is missing, has other columns, or has no rows
/// left.
std::vector<ComparisonRow> read_comparison(const std::filesystem::path& folder,
                                           std::vector<std::string>& skipped);

}  // namespace item3d
