// Options of a job as command-line arguments and as part of its identity.
#pragma once

#include "item3d/batch/columns.h"
#include "item3d/batch/content_hash.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// True for a string without a zero character. An argument or a path would end at such a character.
bool is_argument(const nlohmann::json& value);

/// True for options whose values may have the path of a file or a folder: PATH, PATH:MORE or
/// KEY=PATH.
bool may_name_a_file(const std::string& option);

/// Returns the value of an option. If it has a path relative to `folder` at which there is a file
/// or a folder, that path is made absolute.
std::string with_absolute_path(const std::string& option, const std::string& value,
                               const std::filesystem::path& folder);

struct JobOptions {
    std::vector<std::string> arguments;  ///< --NAME VALUE ..., in the order of the names
    /// The arguments with hashes in place of paths, and without the prior.
    std::string identity;
};

/// Converts a job's values to options. values: an object with the option names as keys, and
/// strings, numbers, booleans or lists of these as values. Throws InputError that names `subject`
/// and the option if a value does not match the option's kind.
JobOptions job_options(const nlohmann::json& values, const JobCommand& command,
                       const std::filesystem::path& folder, const std::string& subject,
                       ContentHashes& hashes);

}  // namespace item3d
