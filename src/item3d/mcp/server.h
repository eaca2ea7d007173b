// Server of the Model Context Protocol (modelcontextprotocol.io) on standard input and output:
// agents call commands of item3d as tools.
#pragma once

#include "item3d/mcp/allowed_folders.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

struct McpOptions {
    std::filesystem::path launcher;  ///< path of the program item3d
    std::filesystem::path scratch;   ///< folder for running tools, removed at the end
    nlohmann::json settings;         ///< contents of web/settings.json
};

/// Serves until standard input ends or the process is interrupted. If a tool is still running at
/// that time, it is asked to end. One tool runs at a time; further calls wait. Throws ResourceError
/// if standard output cannot be written.
void serve_mcp(const AllowedFolders& folders, const McpOptions& options);

}  // namespace item3d
