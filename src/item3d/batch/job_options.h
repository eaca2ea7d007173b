// Options of a job: as arguments for the command, and as what decides the result.
#pragma once

#include "item3d/batch/columns.h"
#include "item3d/batch/content_hash.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Whether it is a text that a program can be given: an argument ends at a zero character, as does
/// a path.
bool is_argument(const nlohmann::json& value);

/// Columns that hold files or folders, alone, or as FILE:MORE or KEY=FILE.
bool may_name_a_file(const std::string& option);

/// A value whose relative path, if it holds one, begins at `folder`: absolute where such a file is
/// there, else as it was.
std::string with_absolute_path(const std::string& option, const std::string& value,
                               const std::filesystem::path& folder);

struct JobOptions {
    std::vector<std::string> arguments;  ///< --name value ..., in the order of names
    /// The same with hashes of files in place of paths, without the prior.
    std::string identity;
};

/// values: by option names, texts, numbers, booleans or lists of them. Throws InputError that names
/// `subject` and the option where a value does not suit its kind.
JobOptions job_options(const nlohmann::json& values, const JobCommand& command,
                       const std::filesystem::path& folder, const std::string& subject,
                       ContentHashes& hashes);

}  // namespace item3d
