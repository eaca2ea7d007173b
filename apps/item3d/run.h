// The main() of each family of commands.
#pragma once

#include <CLI/CLI.hpp>

#include <initializer_list>

namespace item3d {

/// Adds a command, or several, to the program's.
using AddCommand = void (*)(CLI::App&);

/// Reads the command line, runs one command, turns what it throws into a line on stderr, and ends
/// the process with the exit code. Destructors of static objects are not run.
[[noreturn]] void run_program(int argc, char** argv,
                              std::initializer_list<AddCommand> add_commands);

}  // namespace item3d
