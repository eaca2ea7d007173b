// The studio without its sockets: all actions of the page.
#pragma once

#include "item3d/serve/folder_lock.h"
#include "item3d/studio/access.h"
#include "item3d/studio/commands.h"
#include "item3d/studio/events.h"
#include "item3d/studio/folders.h"
#include "item3d/studio/jobs.h"
#include "item3d/studio/store.h"

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct StudioOptions {
    std::filesystem::path folder;    ///< folder of projects and results
    std::filesystem::path page;      ///< folder web/
    std::filesystem::path three;     ///< three.js
    std::filesystem::path programs;  ///< folder of item3d-edit and the other programs
    AccessOptions access;
};

/// The studio. It is thread-safe. The messages of its exceptions may have paths of this machine,
/// which folders().without_paths() removes.
class Studio {
  public:
    /// Throws InputError if another program serves the folder, or if the folder is unusable.
    explicit Studio(StudioOptions options);

    const StudioOptions& options() const { return options_; }
    const StudioFolders& folders() const { return folders_; }
    StudioStore& store() { return store_; }
    StudioEvents& events() { return events_; }
    StudioAccess& access() { return access_; }
    StudioJobs& jobs() { return jobs_; }
    const StudioCommands& commands() const { return commands_; }

    /// Makes a new project from a model file, in incoming/ or elsewhere, or from the model in a
    /// .zip. name: the user's name of the file, with its extension. Throws InputError if the file
    /// is not a model.
    StudioProject open_model(const std::filesystem::path& file, const std::string& name);
    /// Makes a new project from a folder with a model and the files that it names, and moves the
    /// folder into the project. model: path relative to the folder.
    StudioProject open_folder(const std::filesystem::path& folder,
                              const std::filesystem::path& model);
    /// Returns the existing project of this file. If there is none, makes a new project, with
    /// copies of the files in the model's folder that the model names.
    StudioProject open_again(const std::filesystem::path& file);
    /// Makes a new project without a model from a folder of photographs, and moves the folder into
    /// the project. Returns the result that reconstructs the model.
    StudioResult reconstruct(const std::filesystem::path& photographs, const std::string& name);
    /// Removes a project with all of its results. Throws InputError while one of the results runs.
    void remove_project(std::int64_t id);

    /// Returns the project. Throws InputError if there is no such project.
    StudioProject project(std::int64_t id);
    StudioResult result(std::int64_t id);
    /// Returns the downloadable files of a result by name ("textures/mug_orm.png").
    std::vector<std::string> files_of(const StudioResult& result) const;

    /// Runs a command and blocks until its end. At any time at most one command of the family
    /// "studio" runs, and at most one of all other families. log: new file for the command's
    /// output. Throws the error that the command reports.
    void run_now(const StudioCommand& command, const std::filesystem::path& folder,
                 const std::filesystem::path& log, std::chrono::seconds longest);

  private:
    /// Completes a finished result. The queue calls this function.
    void take_result(StudioResult& result);
    JobClock clock_of(const StudioResult& result);
    /// Makes a project of a model. name: the user's name of the file. place: function that puts the
    /// model's files into the given folder source/ and returns the path of the model there.
    StudioProject add_project(
        const std::string& name,
        const std::function<std::filesystem::path(const std::filesystem::path& source)>& place);
    void read_model(std::int64_t project, const std::filesystem::path& model);
    void remove_unread_projects();

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

/// Returns the path of the model that the program ships.
std::filesystem::path demo_model();

}  // namespace item3d
