// Jobs as they are asked for: rows of a file, or all combinations of what options give.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct JobRow {
    nlohmann::json values;         ///< an object: columns and what they hold
    std::filesystem::path folder;  ///< where relative paths begin
    std::string place;             ///< for messages: "jobs.csv: row 3"
};

/// Rows of a CSV file with a header (.csv), a JSON list of objects, or JSON Lines. Empty fields say
/// nothing. Throws InputError that names file and row.
std::vector<JobRow> read_job_rows(const std::filesystem::path& file);

/// Jobs by options.
struct JobMatrix {
    std::vector<std::string> models;  ///< files, or patterns as shells have them ("shop/*.glb")
    std::vector<std::string> from;    ///< one, or as many as `to`
    std::vector<std::string> to;
};

/// A row for each model and pair of sentences. Throws UsageError where sentences do not pair, and
/// InputError for a pattern that no file matches.
std::vector<JobRow> matrix_rows(const JobMatrix& matrix);

/// Gives every row each combination of these values: NAME=VALUE, a name several times for several
/// values. What a row had is replaced. Throws UsageError for a text without "=", and where rows of
/// several values have names, which would not tell them apart any more.
std::vector<JobRow> with_values(const std::vector<JobRow>& rows,
                                const std::vector<std::string>& values);

}  // namespace item3d
