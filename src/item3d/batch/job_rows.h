// Rows that request jobs. They come from a file, or from all combinations of option values.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct JobRow {
    nlohmann::json values;         ///< an object with the columns as keys
    std::filesystem::path folder;  ///< folder at which relative paths start
    std::string place;             ///< for messages: "jobs.csv: row 3"
};

/// Reads rows of a CSV file with a header (.csv), a JSON list of objects, or JSON Lines. Ignores
/// empty fields. Throws InputError that names file and row.
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

/// Returns a copy of each row for each combination of the given values, which replace the row's own
/// values. values: strings NAME=VALUE; several values of a column repeat the name. Throws
/// UsageError for a string without "=". Throws it also if a row with a name would get several
/// copies, because names must be unique.
std::vector<JobRow> with_values(const std::vector<JobRow>& rows,
                                const std::vector<std::string>& values);

}  // namespace item3d
