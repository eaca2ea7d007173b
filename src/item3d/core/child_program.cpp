#include "item3d/core/child_program.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>

namespace item3d {

namespace {

namespace fs = std::filesystem;

/// Blocks all signals of this thread until the end of a scope.
class BlockedSignals {
  public:
    BlockedSignals() {
        sigset_t all;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    BlockedSignals(const BlockedSignals&) = delete;
    BlockedSignals& operator=(const BlockedSignals&) = delete;
    const sigset_t& before() const { return before_; }

  private:
    sigset_t before_;
};

/// Removes this program's handlers of signals from the new process. A handler would take a request
/// to end that arrives before exec(), and the program would never receive it.
void end_on_signals(const sigset_t& signals_before) {
    for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
        struct sigaction action = {};
        if (::sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
            ::signal(signal, SIG_DFL);
    }
    ::sigprocmask(SIG_SETMASK, &signals_before, nullptr);
}

/// Turns the new process into the program. Until exec(), it shares this program's memory, and other
/// threads may hold any lock, so only async-signal-safe calls are allowed, and nothing may change.
[[noreturn]] void become(const char* program, char* const* arguments, const char* output,
                         const char* folder, const cpu_set_t& cores, pid_t parent) {
    ::setpgid(0, 0);
    // The program runs on all cores if the system refuses this affinity.
    if (CPU_COUNT(&cores) > 0) ::sched_setaffinity(0, sizeof(cores), &cores);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open(output, O_WRONLY | O_CREAT | O_APPEND, 0644);
    const bool is_there = *folder == '\0' || ::chdir(folder) == 0;
    if (is_there && ::getppid() == parent && in >= 0 && out >= 0 && ::dup2(in, STDIN_FILENO) >= 0 &&
        ::dup2(out, STDOUT_FILENO) >= 0 && ::dup2(out, STDERR_FILENO) >= 0 &&
        // Closes all other files, including a server's sockets.
        ::close_range(STDERR_FILENO + 1, ~0U, 0) == 0)
        ::execv(program, arguments);
    ::_exit(127);
}

}  // namespace

fs::path program_in_path(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    std::error_code ignored;
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path program = fs::path(folder) / name;
        if (!folder.empty() && fs::is_regular_file(program, ignored) &&
            ::access(program.c_str(), X_OK) == 0)
            return program;
    }
    return {};
}

std::string reason_of_end(const fs::path& log, int status) {
    std::istringstream lines(read_text(log));
    std::string reason;
    constexpr std::string_view mark = "item3d: error: ";
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(mark)) reason = line.substr(mark.size());
    if (!reason.empty()) return reason;
    if (WIFSIGNALED(status))
        return fmt::format("ended by signal {}, see {}", WTERMSIG(status), log.string());
    return fmt::format("ended with code {}, see {}", WEXITSTATUS(status), log.string());
}

ChildProgram::ChildProgram(const std::vector<std::string>& arguments, const fs::path& output,
                           const ChildSurroundings& surroundings) {
    std::vector<std::string> copies = arguments;
    if (!surroundings.name.empty()) copies[0] = surroundings.name;
    std::vector<char*> pointers;
    for (std::string& copy : copies)
        pointers.push_back(copy.data());
    pointers.push_back(nullptr);
    cpu_set_t cores;
    CPU_ZERO(&cores);
    for (const int core : surroundings.cores)
        CPU_SET(core, &cores);
    const pid_t parent = ::getpid();
    const BlockedSignals blocked;  // until the new process has removed the handlers
    // Unlike fork(), vfork() copies no page tables, which takes long in a program with much memory,
    // and calls no library's handlers, which may wait for a lock of another thread forever.
    id_ = ::vfork();
    if (id_ < 0) throw ResourceError(arguments[0] + ": cannot be started: " + std::strerror(errno));
    if (id_ == 0) {
        end_on_signals(blocked.before());
        become(arguments[0].c_str(), pointers.data(), output.c_str(), surroundings.folder.c_str(),
               cores, parent);
    }
    // Parent and child both call it, so that neither runs on without the group.
    ::setpgid(id_, id_);
}

ChildProgram::~ChildProgram() {
    if (status_) return;
    ::kill(-id_, SIGKILL);
    while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
}

void ChildProgram::ask_to_end() {
    if (!status_) ::kill(-id_, SIGTERM);
}

void ChildProgram::kill() {
    if (!status_) ::kill(-id_, SIGKILL);
}

std::optional<int> ChildProgram::status() {
    if (status_) return status_;
    int status = 0;
    const pid_t ended = ::waitpid(id_, &status, WNOHANG);
    if (ended == id_) status_ = status;
    // The exit status is lost if SIGCHLD is ignored. The child's errors are then visible only in
    // its output.
    if (ended < 0 && errno == ECHILD) status_ = 0;
    return status_;
}

}  // namespace item3d
