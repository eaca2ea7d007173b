// The way from the command line to the exit code, for programs with and without LibTorch.
#pragma once

#include "item3d/core/error.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <initializer_list>
#include <string>

namespace item3d {

using AddCommand = void (*)(CLI::App&);

/// Parses the command line and runs the command. Prints usage errors. Returns the exit code.
int parse_and_run(int argc, char** argv, std::initializer_list<AddCommand> add_commands);

/// Returns the exit code of `run`, whose errors are printed as one line on stderr.
int guarded(const std::function<int()>& run);

/// Prints one line on stderr. Returns the exit code.
int fail(ExitCode code, const std::string& message);
int fail_as_bug(const std::string& message);
/// Prints that memory is exhausted. Returns the exit code. lacking: text such as "... bytes were
/// wanted", or "".
int fail_out_of_memory(const std::string& lacking);

/// Flushes the output and ends the process without destructors of static objects.
[[noreturn]] void end_program(int code);

}  // namespace item3d
