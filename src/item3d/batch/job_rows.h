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
    std::vector<std::string> from;    ///< source sentences: one, or as many as in `to`
    std::vector<std::string> to;
};

/// Returns a row for each combination of a model and a pair of sentences. Throws UsageError if the
/// numbers of sentences do not match, and InputError for a pattern that matches no file.
std::vector<JobRow> matrix_rows(const JobMatrix& matrix);

/// Returns a copy of each row for each combination of the given values. A value is NAME=VALUE;
/// several values of a column repeat the name. They replace the row's own values. Throws UsageError
/// for a text without "=", and for named rows with several values, whose names would no longer be
/// unique.
std::vector<JobRow> with_values(const std::vector<JobRow>& rows,
                                const std::vector<std::string>& values);

}  // namespace item3d
