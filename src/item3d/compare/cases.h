// The edits that methods are compared by, from a file.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct CompareCase {
    std::string name;  ///< "mug: a golden mug", where the file gives none
    std::filesystem::path model;
    std::string from;
    std::string to;
    std::string expect;  ///< a word of the prior's that the result shall be judged by; may be empty
    /// Further options of `item3d edit` by their long names without dashes; values as JSON has
    /// them.
    nlohmann::json options = nlohmann::json::object();
};

/// Reads a JSON list of objects, or a CSV file with a header. Columns: name and expect
/// (optional), model (a path from the file's folder), from, to, and long options of `item3d edit`
/// with - or _. Empty fields say nothing. Throws InputError that names file, case and column: a
/// case without model, from or to, a model that is not there, an unknown column (with the nearest
/// known one).
std::vector<CompareCase> read_compare_cases(const std::filesystem::path& file);

/// Gives all cases an option of `item3d edit` as "iterations=100", whatever they had. Throws
/// UsageError for a text without "=", InputError as read_compare_cases().
void set_option(std::vector<CompareCase>& cases, const std::string& option);

/// Options as they stand on the command line: --light noon --region a --region b. A list is given
/// with commas where the option takes it so, else the option is repeated; allow-missing-textures is
/// a bare flag where it is true.
std::vector<std::string> option_arguments(const nlohmann::json& options);

}  // namespace item3d
