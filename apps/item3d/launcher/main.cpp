// item3d: answers --help and --version by itself and otherwise becomes item3d-commands, the program
// beside it that has the commands and LibTorch.
#include "texts.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace {

constexpr int done = 0, no_resource = 4;  // item3d::ExitCode

int say(const char* text) {
    const bool said = std::fputs(text, stdout) >= 0 && std::fflush(stdout) == 0;
    return said ? done : no_resource;
}

/// Threads of OpenMP wait for each other by spinning, for so long by default that beside a program
/// that keeps the processor busy an edit takes many times as long: the one that is waited for does
/// not run meanwhile. On a quiet machine a short spin is no slower.
void wait_briefly() {
    if (std::getenv("OMP_WAIT_POLICY") == nullptr) setenv("GOMP_SPINCOUNT", "5000", 0);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2) {
        const std::string_view option = argv[1];
        if (option == "--help" || option == "-h") return say(help_text);
        if (option == "--version") return say(version_text);
    }
    std::error_code code;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", code);
    const auto commands = here.parent_path() / "item3d-commands";
    wait_briefly();
    execv(commands.c_str(), argv);
    std::fprintf(stderr, "item3d: error: %s: %s; install item3d again\n", commands.c_str(),
                 std::strerror(errno));
    return no_resource;
}
