// Child processes, started without a shell.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Returns the first executable file called `name` in the folders of $PATH; empty if there is none.
std::filesystem::path program_in_path(const std::string& name);

/// Environment of a child process.
struct ChildSurroundings {
    std::filesystem::path folder;  ///< working directory; if empty, this program's
    std::string name;              ///< argv[0]; if empty, the program's path
    std::vector<int> cores = {};   ///< CPU affinity; if empty, this program's
};

/// Returns the last error message ("item3d: error: ...") in the log of a child program. If the log
/// has none, describes how the program ended. status: from waitpid().
std::string reason_of_end(const std::filesystem::path& log, int status);

/// A child process in its own process group, so that Ctrl-C on a terminal reaches only this
/// program. The system kills the child when the thread that started it ends. The child inherits no
/// open files.
class ChildProgram {
  public:
    /// Starts the program. arguments: the program's path, then its arguments; output: file to which
    /// its output is appended. If the program cannot be run, the child exits with status 127.
    /// Throws ResourceError if no process can be created.
    ChildProgram(const std::vector<std::string>& arguments, const std::filesystem::path& output,
                 const ChildSurroundings& surroundings = {});
    /// Kills the group if the program still runs, and waits for its end.
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    ChildProgram& operator=(const ChildProgram&) = delete;

    /// Asks the group to end (SIGTERM), so that it can save its state; does not block.
    void ask_to_end();
    /// Kills the group (SIGKILL).
    void kill();
    /// Returns the status from waitpid() if the child has ended, else no value.
    std::optional<int> status();

  private:
    pid_t id_ = -1;
    std::optional<int> status_;
};

}  // namespace item3d
