// Command item3d mcp: serves item3d to agents over the Model Context Protocol.
#include "apps/item3d/command_help.h"
#include "apps/item3d/commands.h"
#include "apps/item3d/studio/commands.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/program.h"
#include "item3d/core/progress.h"
#include "item3d/mcp/server.h"

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct McpCommandOptions {
    std::vector<fs::path> folders;
    fs::path output;
};

nlohmann::json read_settings() {
    const fs::path assets = assets_folder();
    for (const fs::path& file : {assets / "web/settings.json", assets / "../web/settings.json"})
        if (fs::exists(file)) return parse_json_or_throw(read_text(file));
    throw InputError((assets / "web/settings.json").string(), "does not exist",
                     "install item3d again");
}

void run_mcp(const McpCommandOptions& given) {
    set_verbosity(Verbosity::quiet);
    install_interrupt_handler();
    make_output_folder(given.output);
    const AllowedFolders folders(given.folders, given.output);
    McpOptions options;
    options.launcher = launcher_program();
    options.scratch = fs::temp_directory_path() / ("item3d-mcp-" + std::to_string(::getpid()));
    options.settings = read_settings();
    serve_mcp(folders, options);
}

}  // namespace

void add_mcp_command(CLI::App& app) {
    auto options = std::make_shared<McpCommandOptions>();
    CLI::App* command = app.add_subcommand("mcp", std::string(find_command("mcp")->description));
    use_help(*command, command_help("mcp"));
    command->add_option("FOLDER", options->folders,
                        "Folders from which models and images may be read");
    command
        ->add_option("-o,--output", options->output,
                     "Folder for results, each in a new folder; files in it may be read too")
        ->type_name("FOLDER")
        ->required();
    command->footer(
        "An agent starts this command and communicates over standard input and output:\n"
        "  {\"command\": \"item3d\", \"args\": [\"mcp\", \"/home/me/models\", \"-o\", "
        "\"/home/me/item3d\"]}");
    command->callback([options] { run_mcp(*options); });
}

}  // namespace item3d
