// The studio without its sockets: what the page can ask for.
#pragma once

#include "item3d/serve/folder_lock.h"
#include "item3d/studio/access.h"
#include "item3d/studio/commands.h"
#include "item3d/studio/events.h"
#include "item3d/studio/folders.h"
#include "item3d/studio/jobs.h"
#include "item3d/studio/store.h"

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct StudioOptions {
    std::filesystem::path folder;    ///< of projects and results
    std::filesystem::path page;      ///< web/
    std::filesystem::path three;     ///< three.js
    std::filesystem::path programs;  ///< with item3d-edit and the others
    AccessOptions access;
};

/// Thread-safe. Messages of what it throws have no paths of this machine once they went through
/// folders().without_paths().
class Studio {
  public:
    /// Throws InputError where another program serves the folder, or it cannot be used.
    explicit Studio(StudioOptions options);

    const StudioOptions& options() const { return options_; }
    const StudioFolders& folders() const { return folders_; }
    StudioStore& store() { return store_; }
    StudioEvents& events() { return events_; }
    StudioAccess& access() { return access_; }
    StudioJobs& jobs() { return jobs_; }
    const StudioCommands& commands() const { return commands_; }

    /// A new project of a model that lies in incoming/ or elsewhere; of a .zip the model in it.
    /// name: as somebody gave it, with its extension. Throws InputError where it is no model.
    StudioProject open_model(const std::filesystem::path& file, const std::string& name);
    /// The project that was made of this very file, else a new one.
    StudioProject open_again(const std::filesystem::path& file);
    /// A new project without a model, made of a folder of photographs, which is moved; the result
    /// that reconstructs it.
    StudioResult reconstruct(const std::filesystem::path& photographs, const std::string& name);
    /// With all of its results. Throws InputError while one of them runs.
    void remove_project(std::int64_t id);

    /// Throws InputError where there is none.
    StudioProject project(std::int64_t id);
    StudioResult result(std::int64_t id);
    /// Files of a result that can be asked for, by their names ("textures/mug_orm.png").
    std::vector<std::string> files_of(const StudioResult& result) const;

    /// Runs a command to its end while the caller waits, one of a family at a time. log: what it
    /// prints, and nothing that it had before. Throws its error.
    void run_now(const StudioCommand& command, const std::filesystem::path& folder,
                 const std::filesystem::path& log, std::chrono::seconds longest);

  private:
    /// Called by the queue with a result that is done.
    void take_result(StudioResult& result);
    JobClock clock_of(const StudioResult& result);
    void read_model(std::int64_t project, const std::filesystem::path& model);

    StudioOptions options_;
    StudioFolders folders_;
    FolderLock lock_;
    StudioStore store_;
    StudioEvents events_;
    StudioAccess access_;
    StudioCommands commands_;
    std::mutex reading_, running_now_;
    StudioJobs jobs_;
};

/// The model that the program ships.
std::filesystem::path demo_model();

}  // namespace item3d
