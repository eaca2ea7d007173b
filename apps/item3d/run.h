// The main function of each family of commands.
#pragma once

#include "apps/item3d/program.h"

namespace item3d {

/// Parses the command line, runs one command, prints its error as one line on stderr, and ends the
/// process with the exit code. Destructors of static objects are not run.
[[noreturn]] void run_program(int argc, char** argv,
                              std::initializer_list<AddCommand> add_commands);

}  // namespace item3d
