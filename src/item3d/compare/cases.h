// Test cases of a comparison, from a file.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct CompareCase {
    std::string name;  ///< unique; by default such as "mug: a golden mug"
    std::filesystem::path model;
    std::string from;
    std::string to;
    std::string expect;  ///< word of the prior that the result should show; may be empty
    /// Further options of `item3d edit`, by long name without the leading dashes.
    nlohmann::json options = nlohmann::json::object();
    /// `model` as written in the file of cases; empty for a suite's cases.
    std::string given_model = {};
};

/// Reads a JSON list of objects, or a CSV file with a header. The columns are `name` and `expect`
/// (both optional), `model` (a path relative to the file's folder), `from`, `to`, and long options
/// of `item3d edit`, written with - or _. Ignores empty fields. Gives each unnamed case a different
/// name. Throws InputError that names file, case and column for a case without model, from or to,
/// for a missing model, an unknown column (with a similar known one), a column given twice, two
/// cases with one name, and two equal unnamed cases.
std::vector<CompareCase> read_compare_cases(const std::filesystem::path& file);

/// Sets options of `item3d edit` in the cases that do not give them. options: strings such as
/// "iterations=100". Throws UsageError for a string without "=", for an unknown option, and for an
/// option given twice. Throws InputError for a value that check_option() refuses, even if no case
/// uses the value.
void set_defaults(std::vector<CompareCase>& cases, const std::vector<std::string>& options);

/// Returns options as command-line arguments: --light noon --region a --region b. For a list, the
/// values are joined by commas if the option takes such values, else the option is repeated.
/// allow-missing-textures has no value; it is given if true.
std::vector<std::string> option_arguments(const nlohmann::json& options);

}  // namespace item3d
