// JSON description of a program's commands, from which scripts/reference.py makes man pages, shell
// completions and docs/reference/commands.md.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace item3d {

/// Returns {"name": "item3d edit", "description", "usage", "options": [{"names", "value",
/// "description", "group", "required", "positional", "first_screen", "repeated"}], "notes",
/// "examples": [{"purpose", "command"}], "page", "commands": [...]}.
nlohmann::json command_description(const CLI::App& command);

}  // namespace item3d
