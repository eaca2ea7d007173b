// The progress of a command, as a small JSON file for programs that started it.
#pragma once

#include <cstdint>
#include <string>

namespace item3d {

/// Makes the program write its progress to a JSON file, which is replaced atomically at most three
/// times a second. Keys: "stage" ("load", "fit", "edit", ...), "done", "total" (0: unknown) and
/// "seconds_left" of the stage (null: unknown). Called once by main(); an empty path: no file.
void show_progress_in(const std::string& path);

/// Begins a stage without steps.
void show_stage(const std::string& stage);
/// Reports the steps of a stage; called by Progress. own: steps that this run did, in `seconds`.
/// Warns once of a file that cannot be written.
void show_steps(const std::string& stage, std::int64_t own, std::int64_t done, std::int64_t total,
                double seconds);

}  // namespace item3d
