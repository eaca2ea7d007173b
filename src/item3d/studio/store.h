// Database of the studio, studio.sqlite, with projects and the history of their results.
#pragma once

#include "item3d/serve/sqlite.h"
#include "item3d/studio/records.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

namespace item3d {

/// Store of projects and results. It is thread-safe. Each member function returns when its change
/// is on disk. All member functions throw like Sqlite.
class StudioStore {
  public:
    /// Opens the database of the folder, or creates it. Throws InputError if it is damaged or of a
    /// later version.
    explicit StudioStore(const std::filesystem::path& folder);

    std::int64_t add_project(const std::string& name);
    /// Sets the model's file and facts, after the model was read.
    void set_model(std::int64_t project, const std::string& file, const nlohmann::json& model);
    void rename_project(std::int64_t project, const std::string& name);
    void mark_project(std::int64_t project, bool favourite);
    std::optional<StudioProject> project(std::int64_t id);
    /// Returns at most `limit` projects with ids below `before`, newest first. If `before` is 0,
    /// ids are not limited.
    std::vector<StudioProject> projects(std::int64_t limit, std::int64_t before);
    /// Removes a project with its results.
    void remove_project(std::int64_t id);

    /// Adds a result, with a new id and the current time.
    StudioResult add_result(const StudioResult& result);
    /// Updates the queue's columns: state, message, seconds, scores, files and command.
    void update_result(const StudioResult& result);
    /// Updates the user's columns: name, note and favourite.
    void annotate_result(const StudioResult& result);
    std::optional<StudioResult> result(std::int64_t id);
    /// Returns the project's results in the order of their ids. Without a project, returns the
    /// results of all projects.
    std::vector<StudioResult> results(std::optional<std::int64_t> project);
    std::vector<StudioResult> results_in(ResultState state);
    void remove_result(std::int64_t id);

  private:
    std::mutex mutex_;
    Sqlite database_;
};

}  // namespace item3d
