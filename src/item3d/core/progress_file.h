// The progress of a command in a small JSON file, for programs that started the command.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
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

/// Reads a progress file. Returns nullopt if it is not an object with a text "stage" and integers
/// "done" and "total", or if "seconds_left" is neither a number nor null. Throws InputError if the
/// file cannot be read.
std::optional<nlohmann::json> read_progress(const std::filesystem::path& path);

}  // namespace item3d
