// The studio's database: studio.sqlite, with projects and the history of their results.
#pragma once

#include "item3d/serve/sqlite.h"
#include "item3d/studio/records.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

namespace item3d {

/// Members may be called by several threads; each returns when what it changed is on the disk. All
/// throw what Sqlite throws.
class StudioStore {
  public:
    /// Opens the database of the folder, or makes it. Throws InputError where it is damaged or was
    /// made by a later version.
    explicit StudioStore(const std::filesystem::path& folder);

    std::int64_t add_project(const std::string& name);
    /// What the model is, once it was read.
    void set_model(std::int64_t project, const std::string& file, const nlohmann::json& model);
    void rename_project(std::int64_t project, const std::string& name);
    void mark_project(std::int64_t project, bool favourite);
    std::optional<StudioProject> project(std::int64_t id);
    /// Newest first, of smaller ids than `before` where that is not 0.
    std::vector<StudioProject> projects(std::int64_t limit, std::int64_t before);
    /// With its results.
    void remove_project(std::int64_t id);

    /// Gives it an id and a time.
    StudioResult add_result(const StudioResult& result);
    /// What the queue says: state, message, seconds, scores, files and command.
    void update_result(const StudioResult& result);
    /// What people say: name, note and favourite.
    void annotate_result(const StudioResult& result);
    std::optional<StudioResult> result(std::int64_t id);
    /// By id. Without a project all.
    std::vector<StudioResult> results(std::optional<std::int64_t> project);
    std::vector<StudioResult> results_in(ResultState state);
    void remove_result(std::int64_t id);

  private:
    std::mutex mutex_;
    Sqlite database_;
};

}  // namespace item3d
