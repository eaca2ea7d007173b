// Commands of item3d-studio.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_studio_command(CLI::App& app);
void add_mcp_command(CLI::App& app);
/// Adds the command by which the studio reads a model for the page.
void add_read_model_command(CLI::App& app);

}  // namespace item3d
