// The common options of all commands, and the output of results on stdout.
//
// A command is one file of its family's folder, apps/item3d/FAMILY/COMMAND.cpp, with one function
// that adds it:
//
//     struct RenderOptions : CommonOptions { std::string model; };
//
//     void add_render_command(CLI::App& app) {
//         auto options = std::make_shared<RenderOptions>();
//         CLI::App* command = add_command(app, "render", *options);
//         command->add_option("MODEL", options->model, "Model to be rendered")->required();
//         command->callback([options] { run_render(*options, start_command(*options)); });
//     }
//
// The name and the description of the command go into commands.h. Its function goes into
// FAMILY/commands.h and FAMILY/main.cpp. Errors are thrown (core/error.h); run_program() turns them
// into one line on stderr and the exit code.
#pragma once

#include "item3d/tensors/tensor.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Options of every command.
struct CommonOptions {
    bool quiet = false;         ///< true: only warnings and errors on stderr
    bool json = false;          ///< true: the result as one JSON object on stdout
    int threads = 0;            ///< 0: one per core
    std::string progress_file;  ///< file of show_progress_in(); empty: no file
    /// Cpu, cuda, or auto, which is cuda if this build and machine have it.
    std::string device = "auto";
};

/// Adds a command of commands.h that stores the common options in `options`. The options must live
/// as long as `app`; a shared pointer in the command's callback ensures that.
CLI::App* add_command(CLI::App& app, const std::string& name, CommonOptions& options);
/// Adds a command of commands.h that has subcommands.
CLI::App* add_command_group(CLI::App& app, const std::string& name);
/// Adds a subcommand to a group.
CLI::App* add_command(CLI::App& group, const std::string& name, const std::string& description,
                      CommonOptions& options);

/// Adds the common options to an app that is not a command of commands.h.
void add_common_options(CLI::App& command, CommonOptions& options);

/// Applies the common options to the process (verbosity, threads), installs the interrupt handler,
/// and returns the device to compute on. Throws ResourceError if that device is missing.
at::Device start_command(const CommonOptions& options);

/// Returns the command line as typed but without --progress-file, quoted for a shell.
std::string command_line();
/// Returns arguments as a quoted command line.
std::string quoted_command(const std::vector<std::string>& arguments);

/// Returns a check for seeds. CLI11 alone takes -1, and numbers that are too large, for the largest
/// number.
CLI::Validator seed_check();

/// Returns `folder`, or if it is empty the folder of the embedded prior's own network ("clip",
/// "captioner"). Throws InputError that names `option` if there is none.
std::string given_or_embedded(const std::string& folder, const std::string& network,
                              const std::string& option);

/// Writes one JSON object and a newline to stdout. Throws ResourceError if stdout is full.
void print_json(const nlohmann::json& value);

}  // namespace item3d
