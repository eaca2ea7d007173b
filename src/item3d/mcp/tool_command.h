// Conversion of an agent's checked arguments to a command line.
#pragma once

#include "item3d/mcp/allowed_folders.h"
#include "item3d/mcp/tool.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Returns the tool's entry of tools/list: name, title, description, and JSON Schema of the
/// arguments.
nlohmann::json description_of(const Tool& tool);

/// Command of a tool call.
struct ToolCommand {
    const Tool* tool;
    std::vector<std::string> arguments;  ///< the command's name first
    std::filesystem::path result;        ///< folder of the result; empty if it has none
};
/// Checks arguments and creates the result's folder. settings: contents of web/settings.json, which
/// lists the allowed names in the argument "settings". Throws InputError for arguments that are
/// missing, unknown, of another type, or outside the folders.
ToolCommand command_of(const Tool& tool, const nlohmann::json& given, const AllowedFolders& folders,
                       const nlohmann::json& settings);

}  // namespace item3d
