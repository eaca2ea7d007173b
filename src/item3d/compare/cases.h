// Test cases of a comparison, from a file.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct CompareCase {
    std::string name;  ///< unique; default: "mug: a golden mug"
    std::filesystem::path model;
    std::string from;
    std::string to;
    std::string expect;  ///< word of the prior expected in the result; may be empty
    /// Further options of `item3d edit` by long name without dashes; JSON values.
    nlohmann::json options = nlohmann::json::object();
    std::string given_model = {};  ///< `model` as the file of cases writes it; may be empty
};

/// Reads a JSON list of objects, or a CSV file with a header. Columns: name and expect (optional),
/// model (relative to the file's folder), from, to, and long options of `item3d edit` with - or _.
/// Empty fields are ignored. Unnamed cases get different names. Throws InputError that names file,
/// case and column: a case without model, from or to, a missing model, an unknown column (with a
/// similar known one), a column given twice, two cases of one name, two equal unnamed cases.
std::vector<CompareCase> read_compare_cases(const std::filesystem::path& file);

/// Sets options of `item3d edit`, each given as "iterations=100", in the cases that do not give
/// them. Throws UsageError for a text without "=", an unknown option, and one given twice;
/// InputError for a value that check_option() refuses, even where no case uses it.
void set_defaults(std::vector<CompareCase>& cases, const std::vector<std::string>& options);

/// Returns options as command-line arguments: --light noon --region a --region b. A list is joined
/// by commas if the option takes it so, else the option is repeated; allow-missing-textures is a
/// bare flag if true.
std::vector<std::string> option_arguments(const nlohmann::json& options);

}  // namespace item3d
