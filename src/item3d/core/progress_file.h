// How far a command is, for programs that started it: a small JSON file that is renewed.
#pragma once

#include <cstdint>
#include <string>

namespace item3d {

/// From now on progress is written to that file, replaced as a whole at most three times a second:
/// "stage" ("load", "fit", "edit", ...), "done", "total" (0: nobody knows) and "seconds_left" of
/// the stage, or null. Set once by main(); empty: nowhere.
void show_progress_in(const std::string& path);

/// A stage without steps begins.
void show_stage(const std::string& stage);
/// Steps of a stage, of which this run did `own` in so many seconds; Progress calls it. A file that
/// cannot be written is warned of once.
void show_steps(const std::string& stage, std::int64_t own, std::int64_t done, std::int64_t total,
                double seconds);

}  // namespace item3d
