// The commands of item3d-studio.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_studio_command(CLI::App& app);
void add_mcp_command(CLI::App& app);
/// Reads a model for the page; started by the studio.
void add_read_model_command(CLI::App& app);

}  // namespace item3d
