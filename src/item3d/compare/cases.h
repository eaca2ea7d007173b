// The edits that methods are compared by: a file's, or those that come along.
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
    /// Further options of `item3d edit` by their long names without dashes; values as JSON has
    /// them.
    nlohmann::json options = nlohmann::json::object();
};

/// Of a JSON list of objects, or a CSV file with a header. Columns: name (optional), model (a path
/// from the file's folder), from, to, and long options of `item3d edit` with - or _. Empty fields
/// say nothing. Throws InputError that names file, case and column: a case without model, from or
/// to, a model that is not there, an unknown column (with the nearest known one).
std::vector<CompareCase> read_compare_cases(const std::filesystem::path& file);

/// A colour and a material for the demo's mug and for two of the suite's shapes, a rabbit and a
/// teapot, which are written as `folder`/NOUN.glb in a plain colour of the prior's. Throws
/// InputError where the prior has no such colour.
std::vector<CompareCase> default_compare_cases(const std::filesystem::path& folder,
                                               const std::filesystem::path& prior);

/// What `options` are on the command line: --light noon --region a --region b. A list is given with
/// commas where the option takes it so, else the option is repeated; allow-missing-textures is a
/// bare flag where it is true.
std::vector<std::string> option_arguments(const nlohmann::json& options);

}  // namespace item3d
