// Arguments of an agent's call, checked, as a command line.
#pragma once

#include "item3d/mcp/allowed_folders.h"
#include "item3d/mcp/tool.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// As tools/list has it: name, title, description, JSON Schema of the arguments.
nlohmann::json description_of(const Tool& tool);

/// A tool's command with the arguments that were given.
struct ToolCommand {
    const Tool* tool;
    std::vector<std::string> arguments;  ///< from the command's name on
    std::filesystem::path result;        ///< its folder; empty: none
};
/// Makes the result's folder. settings: web/settings.json, what `settings` may name. Throws
/// InputError for arguments that are missing, unknown, of another type, or outside the folders.
ToolCommand command_of(const Tool& tool, const nlohmann::json& given, const AllowedFolders& folders,
                       const nlohmann::json& settings);

}  // namespace item3d
