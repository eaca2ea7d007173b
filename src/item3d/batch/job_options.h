// Options of a job as command-line arguments and as part of its identity.
#pragma once

#include "item3d/batch/columns.h"
#include "item3d/batch/content_hash.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// True for a text without a zero character, at which an argument or a path would end.
bool is_argument(const nlohmann::json& value);

/// True for columns that may hold files or folders, alone or as FILE:MORE or KEY=FILE.
bool may_name_a_file(const std::string& option);

/// Returns the value with its relative path, if any, made absolute from `folder` if that file
/// exists; else unchanged.
std::string with_absolute_path(const std::string& option, const std::string& value,
                               const std::filesystem::path& folder);

struct JobOptions {
    std::vector<std::string> arguments;  ///< --name value ..., in the order of names
    /// Arguments with hashes in place of file paths, without the prior.
    std::string identity;
};

/// Converts values by option name: strings, numbers, booleans or lists of them. Throws InputError
/// that names `subject` and the option if a value does not match the option's kind.
JobOptions job_options(const nlohmann::json& values, const JobCommand& command,
                       const std::filesystem::path& folder, const std::string& subject,
                       ContentHashes& hashes);

}  // namespace item3d
