// Launcher item3d: answers --help and --version itself. For other arguments it executes the program
// of the command's family. That program loads LibTorch, which takes longer than printing the help.
#include "apps/item3d/commands.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace item3d {
namespace {

constexpr int done = 0, usage = 2, no_resource = 4;  // item3d::ExitCode

std::string list_of_commands() {
    std::string list;
    for (const CommandEntry& command : commands) {
        std::string line = "  " + std::string(command.name);
        line.resize(30, ' ');
        list += line + std::string(command.description) + "\n";
    }
    return list;
}

std::string help() {
    return "Edits the look of textured 3D models from two sentences.\n\n"
           "Usage: item3d COMMAND [OPTIONS]\n\n"
           "Options:\n"
           "  -h, --help                  Print this help and exit\n"
           "      --version               Print the version and exit\n\n"
           "Commands:\n" +
           list_of_commands() +
           "\n"
           "`item3d COMMAND --help` shows a command's options, examples and documentation page.\n"
           "Start with README.md, or with your own model:\n"
           "  item3d edit mug.glb --from \"a red mug\" --to \"a golden mug\" -o golden\n";
}

int say(const std::string& text) {
    const bool said = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    if (said) return done;
    std::fprintf(stderr, "item3d: error: stdout: cannot be written: %s\n", std::strerror(errno));
    return no_resource;
}

int refuse(const std::string& problem) {
    std::fprintf(stderr, "item3d: error: %s; `item3d --help` lists the commands\n",
                 problem.c_str());
    return usage;
}

/// Shortens the time for which OpenMP threads spin while they wait for each other. By default they
/// spin for long. If another program keeps the cores busy, the spinning threads keep the awaited
/// thread from running, and an edit takes many times as long. On an idle machine a short spin is no
/// slower.
void wait_briefly() {
    if (std::getenv("OMP_WAIT_POLICY") == nullptr) setenv("GOMP_SPINCOUNT", "5000", 0);
}

/// Returns the path of a family's program. It is beside this program in the build folder, or in
/// lib/item3d after an installation.
std::filesystem::path program_of(std::string_view family) {
    std::error_code code;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
    const auto name = "item3d-" + std::string(family);
    if (std::filesystem::exists(here / name, code)) return here / name;
    return here.parent_path() / "lib/item3d" / name;
}

/// Reports a failed execv(). Returns the exit code.
int could_not_run(const std::filesystem::path& program) {
    const int reason = errno;
    std::error_code code;
    if (!std::filesystem::exists("/proc/self/exe", code))
        std::fprintf(stderr, "item3d: error: /proc is not mounted; mount it\n");
    else if (reason == ENOENT)
        std::fprintf(
            stderr,
            "item3d: error: %s does not exist; install item3d again, or run make in its sources; "
            "item3d can be started by a symbolic link, but not as a copy\n",
            program.c_str());
    else
        std::fprintf(stderr, "item3d: error: %s: %s\n", program.c_str(), std::strerror(reason));
    return no_resource;
}

/// Executes programs/item3d-FAMILY of a package (scripts/package.sh) with the loader and the C
/// library of the package. In a package item3d-FAMILY is itself a copy of this launcher.
int become_packaged(const std::filesystem::path& self, char** arguments) {
    const std::string folder = self.parent_path().string(), system = folder + "/system";
    const std::string loader = system + "/ld-linux-x86-64.so.2", libraries = folder + ":" + system,
                      program = folder + "/programs/" + self.filename().string();
    std::vector<const char*> all = {loader.c_str(), "--library-path", libraries.c_str(),
                                    "--argv0",      arguments[0],     program.c_str()};
    for (char** argument = arguments + 1; *argument != nullptr; ++argument)
        all.push_back(*argument);
    all.push_back(nullptr);
    execv(loader.c_str(), const_cast<char**>(all.data()));
    return could_not_run(loader);
}

int become(const CommandEntry& command, char** arguments) {
    const auto program = program_of(command.family);
    wait_briefly();
    execv(program.c_str(), arguments);
    return could_not_run(program);
}

int run_launcher(int argc, char** argv) {
    std::error_code code;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", code);
    if (self.filename().string().starts_with("item3d-")) return become_packaged(self, argv);
    if (argc < 2) return refuse("no command was given");
    const std::string_view first = argv[1];
    if (first == "--help" || first == "-h") return say(help());
    if (first == "--version") return say("item3d " ITEM3D_VERSION "\n");
    if (const CommandEntry* command = find_command(first)) return become(*command, argv);
    return refuse("unknown command '" + std::string(first) + "'");
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    return item3d::run_launcher(argc, argv);
}
