// What the commands share: common options, results on stdout, and how main() finds a command.
//
// A command is one file of this folder, apps/item3d/<command>.cpp, with one function that adds it:
//
//     struct RenderOptions : CommonOptions { std::string model; };
//
//     void add_render_command(CLI::App& app) {
//         auto options = std::make_shared<RenderOptions>();
//         CLI::App* command = add_command(app, "render", "Draw a model", *options);
//         command->add_option("MODEL", options->model, "A .glb, .gltf or .obj file")->required();
//         command->callback([options] { run_render(*options, start_command(*options)); });
//     }
//
// Its name goes into the list in apps/CMakeLists.txt. Errors are thrown (core/error.h); main()
// turns them into one line on stderr and the exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <torch/types.h>

#include <string>

namespace item3d {

/// Options that every command takes.
struct CommonOptions {
    bool quiet = false;           ///< nothing but warnings and errors on stderr
    bool json = false;            ///< the result as one JSON object on stdout
    int threads = 0;              ///< 0: one for each core
    std::string device = "auto";  ///< cpu, cuda, or auto: cuda where this build and machine have it
};

/// Adds a subcommand that takes the common options into `options`, which must live as long as `app`
/// (a shared pointer in the command's callback does).
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      CommonOptions& options);

/// Applies the common options to the process (verbosity, threads), installs the interrupt handler,
/// and returns the device to compute on. Throws ResourceError when that device is not there.
torch::Device start_command(const CommonOptions& options);

/// The command line as typed, quoted for a shell.
std::string command_line();

/// `folder`, or where it is empty that of the embedded prior's own network ("clip", "captioner").
/// Throws InputError that names `option` when there is none.
std::string given_or_embedded(const std::string& folder, const std::string& network,
                              const std::string& option);

/// Writes one JSON object and a line end to stdout. Throws ResourceError when stdout is full.
void print_json(const nlohmann::json& value);

}  // namespace item3d
