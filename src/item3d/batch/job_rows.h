// Requested jobs: rows of a file, or all combinations of option values.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct JobRow {
    nlohmann::json values;         ///< an object: values by column
    std::filesystem::path folder;  ///< base of relative paths
    std::string place;             ///< for messages: "jobs.csv: row 3"
};

/// Reads rows of a CSV file with a header (.csv), a JSON list of objects, or JSON Lines. Empty
/// fields are ignored. Throws InputError that names file and row.
std::vector<JobRow> read_job_rows(const std::filesystem::path& file);

/// Jobs given by options.
struct JobMatrix {
    std::vector<std::string> models;  ///< files, or shell patterns ("shop/*.glb")
    std::vector<std::string> from;    ///< one, or as many as `to`
    std::vector<std::string> to;
};

/// Returns a row for each model and pair of sentences. Throws UsageError if sentences do not pair,
/// and InputError for a pattern that matches no file.
std::vector<JobRow> matrix_rows(const JobMatrix& matrix);

/// Returns each row with each combination of these values: NAME=VALUE, a repeated name for several
/// values. A row's own values are replaced. Throws UsageError for a text without "=", and for named
/// rows with several values, whose names would no longer be unique.
std::vector<JobRow> with_values(const std::vector<JobRow>& rows,
                                const std::vector<std::string>& values);

}  // namespace item3d
