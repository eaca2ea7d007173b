#include "item3d/core/child_program.h"

#include "item3d/core/error.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace item3d {

namespace {

namespace fs = std::filesystem;

/// The new process becomes the program. Only calls that are safe in a signal handler may stand
/// between fork() and exec(): other threads may have held any lock.
[[noreturn]] void become(char* const* arguments, const char* output, pid_t parent) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open(output, O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (::getppid() == parent && in >= 0 && out >= 0 && ::dup2(in, STDIN_FILENO) >= 0 &&
        ::dup2(out, STDOUT_FILENO) >= 0 && ::dup2(out, STDERR_FILENO) >= 0)
        ::execv(arguments[0], arguments);
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

ChildProgram::ChildProgram(const std::vector<std::string>& arguments, const fs::path& output) {
    std::vector<std::string> copies = arguments;
    std::vector<char*> pointers;
    for (std::string& copy : copies)
        pointers.push_back(copy.data());
    pointers.push_back(nullptr);
    const pid_t parent = ::getpid();
    id_ = ::fork();
    if (id_ < 0) throw ResourceError(arguments[0] + ": cannot be started: " + std::strerror(errno));
    if (id_ == 0) become(pointers.data(), output.c_str(), parent);
    ::setpgid(id_, id_);  // both do it: the group must be there before either goes on
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

std::optional<int> ChildProgram::status() {
    if (status_) return status_;
    int status = 0;
    const pid_t ended = ::waitpid(id_, &status, WNOHANG);
    if (ended == id_) status_ = status;
    // Where SIGCHLD is ignored nobody learns how a child ended: what it wrote must tell.
    if (ended < 0 && errno == ECHILD) status_ = 0;
    return status_;
}

}  // namespace item3d
