// Test cases of a comparison, from a file.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct CompareCase {
    std::string name;  ///< default: "mug: a golden mug"
    std::filesystem::path model;
    std::string from;
    std::string to;
    std::string expect;  ///< word of the prior expected in the result; may be empty
    /// Further options of `item3d edit` by long name without dashes; JSON values.
    nlohmann::json options = nlohmann::json::object();
};

/// Reads a JSON list of objects, or a CSV file with a header. Columns: name and expect (optional),
/// model (relative to the file's folder), from, to, and long options of `item3d edit` with - or _.
/// Empty fields are ignored. Throws InputError that names file, case and column: a case without
/// model, from or to, a missing model, an unknown column (with the nearest known one).
std::vector<CompareCase> read_compare_cases(const std::filesystem::path& file);

/// Sets an option of `item3d edit`, given as "iterations=100", in all cases. Throws UsageError for
/// a text without "=", InputError like read_compare_cases().
void set_option(std::vector<CompareCase>& cases, const std::string& option);

/// Returns options as command-line arguments: --light noon --region a --region b. A list is joined
/// by commas if the option takes it so, else the option is repeated; allow-missing-textures is a
/// bare flag if true.
std::vector<std::string> option_arguments(const nlohmann::json& options);

}  // namespace item3d
