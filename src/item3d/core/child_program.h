// Another program, started without a shell.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// The first executable file of that name in the folders of $PATH; empty: there is none.
std::filesystem::path program_in_path(const std::string& name);

/// Where and as what a program runs.
struct ChildSurroundings {
    std::filesystem::path folder;  ///< its working directory; empty: this program's
    std::string name;              ///< that it finds itself called by; empty: its path
    std::vector<int> cores = {};   ///< that it may run on; empty: those of this program
};

/// "error: ..." of the last line of its log in which a program of ours says what went wrong;
/// without one, how it ended. status: of waitpid().
std::string reason_of_end(const std::filesystem::path& log, int status);

/// A running program in a process group of its own, so that Ctrl-C on a terminal reaches this
/// program alone. It ends with the thread that started it, however that ends, and has none of this
/// program's files open.
class ChildProgram {
  public:
    /// arguments: the program's path first; output: a file that what it prints is added to. A
    /// program that cannot be run exits with 127. Throws ResourceError where no process can be
    /// made.
    ChildProgram(const std::vector<std::string>& arguments, const std::filesystem::path& output,
                 const ChildSurroundings& surroundings = {});
    /// Kills the group where the program still runs, and waits for its end.
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    ChildProgram& operator=(const ChildProgram&) = delete;

    /// Asks the group to end (SIGTERM), so that it can keep what it has; returns at once.
    void ask_to_end();
    /// Ends the group at once (SIGKILL).
    void kill();
    /// The status of waitpid() once it has ended; before, nothing.
    std::optional<int> status();

  private:
    pid_t id_ = -1;
    std::optional<int> status_;
};

}  // namespace item3d
