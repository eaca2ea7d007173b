#include "apps/item3d/command.h"

#include "apps/item3d/command_help.h"
#include "apps/item3d/commands.h"
#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/progress_file.h"
#include "item3d/hub/find_prior.h"
#include "item3d/processes/local_device.h"
#include "item3d/render/cuda/module.h"

#include <ATen/Parallel.h>
#include <omp.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace item3d {
namespace {

/// Returns the device. CUDA is usable if both LibTorch's CUDA part and this program's CUDA kernels
/// are present. A CUDA module that is missing or from another build is an error only if the user
/// requested CUDA.
at::Device choose_device(const std::string& name) {
    const at::Device cpu(at::kCPU), first_cuda(at::kCUDA, 0);
    if (name == "cpu") return cpu;
    take_own_device();
    if (!cuda::cuda_available()) {
        if (name == "auto") return cpu;
        throw ResourceError(
            "--device cuda: this build or machine has no CUDA device; use --device cpu or auto");
    }
    try {
        cuda::render_table();
    } catch (const ResourceError& error) {
        if (name != "auto") throw;
        warn(std::string("computing on the CPU: ") + error.what());
        return cpu;
    }
    return first_cuda;
}

/// Returns a name such as "prior train".
std::string name_of(const CLI::App& command) {
    const std::string name = full_name(command);
    return name.substr(name.find(' ') + 1);
}

std::string described(const std::string& name) {
    const CommandEntry* entry = find_command(name);
    ITEM3D_CHECK(entry, "a command that commands.h does not list");
    return std::string(entry->description);
}

}  // namespace

void add_common_options(CLI::App& command, CommonOptions& options) {
    const std::string group = "Common options";
    command.add_flag("--quiet", options.quiet, "Print warnings and errors only")->group(group);
    command.add_flag("--json", options.json, "Print the result as one JSON object on stdout")
        ->group(group);
    command.add_option("--threads", options.threads, "CPU threads. Default: one per core")
        ->check(CLI::Range(1, 1024))
        ->group(group);
    command
        .add_option("--progress-file", options.progress_file,
                    "File that the progress is written to as JSON (stage, steps, seconds left) "
                    "while the command runs")
        ->type_name("FILE")
        ->group(group);
    command
        .add_option("--device", options.device,
                    "Device to compute on; auto uses CUDA if a device is found")
        ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
        ->capture_default_str()
        ->group(group);
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      CommonOptions& options) {
    CLI::App* command = app.add_subcommand(name, description);
    use_help(*command, command_help(name_of(*command)));
    add_common_options(*command, options);
    return command;
}

CLI::App* add_command(CLI::App& app, const std::string& name, CommonOptions& options) {
    return add_command(app, name, described(name), options);
}

CLI::App* add_command_group(CLI::App& app, const std::string& name) {
    CLI::App* group = app.add_subcommand(name, described(name));
    use_help(*group, command_help(name));
    return group;
}

at::Device start_command(const CommonOptions& options) {
    set_verbosity(options.quiet ? Verbosity::quiet : Verbosity::normal);
    // LibTorch and this program's own kernels share the threads of OpenMP, and both get the same
    // number of threads.
    const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
    omp_set_num_threads(threads);
    at::set_num_threads(threads);
    install_interrupt_handler();
    show_progress_in(options.progress_file);

    return choose_device(options.device);
}

CLI::Validator seed_check() {
    return CLI::Validator(
        [](const std::string& text) {
            std::uint64_t value = 0;
            const char* last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data(), last, value);
            return error == std::errc() && end == last
                       ? std::string()
                       : "'" + text + "' is not a whole number from 0 to 2^64 - 1";
        },
        "");
}

std::string command_line() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    std::vector<std::string> arguments;
    for (std::string argument; std::getline(file, argument, '\0');) {
        // The file belongs to the program that started this one.
        if (argument == "--progress-file")
            std::getline(file, argument, '\0');
        else if (!argument.starts_with("--progress-file="))
            arguments.push_back(argument);
    }
    // A package starts programs by its own loader: LOADER --library-path X --argv0 NAME PROGRAM.
    const auto name = std::find(arguments.begin(), arguments.end(), "--argv0");
    if (name - arguments.begin() == 3 && arguments.end() - name > 2) {
        arguments.erase(name + 2);
        arguments.erase(arguments.begin(), name + 1);
    }
    return quoted_command(arguments);
}

std::string quoted_command(const std::vector<std::string>& arguments) {
    std::string line;
    for (const std::string& argument : arguments) {
        const bool plain =
            !argument.empty() &&
            argument.find_first_of(" \t\n'\"\\$`&|;<>()*?[]#~!{}") == std::string::npos;
        if (!line.empty()) line += ' ';
        if (plain) {
            line += argument;
            continue;
        }
        line += '\'';
        for (const char character : argument) {
            line += character == '\'' ? std::string("'\\''") : std::string(1, character);
        }
        line += '\'';
    }
    return line;
}

std::string given_or_embedded(const std::string& folder, const std::string& network,
                              const std::string& option) {
    if (!folder.empty()) return folder;
    const std::filesystem::path prior = find_prior("");
    const std::filesystem::path found = find_in_prior(prior, network);
    if (found.empty())
        throw InputError(prior.string(), "has no " + network, "give its folder with " + option);
    return found.string();
}

void print_json(const nlohmann::json& value) {
    // File names need not be UTF-8; invalid bytes are replaced.
    const std::string text =
        value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        throw ResourceError(std::string("stdout: cannot be written: ") + std::strerror(errno));
    }
}

}  // namespace item3d
