// The progress of a command in a small JSON file, for programs that started the command.
#pragma once

#include <cstdint>
#include <string>

namespace item3d {

/// Makes the program write its progress to a JSON file, which is replaced atomically at most three
/// times a second. The file has the keys "stage" ("load", "fit", "edit", ...), "done", "total" (0:
/// unknown) and "seconds_left" of the stage (null: unknown). main() calls this function once. If
/// the path is empty, no file is written.
void show_progress_in(const std::string& path);

/// Shows that a stage without steps begins.
void show_stage(const std::string& stage);
/// Shows the steps of a stage; called by Progress. own: number of steps that this run did, in
/// `seconds`; done: number of all finished steps. Warns once if the file cannot be written.
void show_steps(const std::string& stage, std::int64_t own, std::int64_t done, std::int64_t total,
                double seconds);

}  // namespace item3d
