// The main() of each family of commands.
#pragma once

#include <CLI/CLI.hpp>

#include <initializer_list>

namespace item3d {

/// Adds a command, or several, to the program's.
using AddCommand = void (*)(CLI::App&);

/// Reads the command line, runs one command, and turns what it throws into a line on stderr.
/// Returns the exit code.
int run_program(int argc, char** argv, std::initializer_list<AddCommand> add_commands);

}  // namespace item3d
