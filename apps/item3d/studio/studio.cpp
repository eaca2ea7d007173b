// Command item3d studio: serves the page for edits in the browser.
#include "apps/item3d/command_help.h"
#include "apps/item3d/commands.h"
#include "apps/item3d/studio/commands.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/program.h"
#include "item3d/core/progress.h"
#include "item3d/serve/http_listener.h"
#include "item3d/serve/secret.h"
#include "item3d/studio/server.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct StudioCommandOptions {
    fs::path model;
    fs::path folder;
    std::string host = "127.0.0.1";
    int port = 0;
    fs::path password_file;
    std::string address;
    bool no_browser = false;
    bool quiet = false;
};

/// Returns $XDG_DATA_HOME/item3d/studio, or ~/.local/share/item3d/studio if XDG_DATA_HOME is not
/// set.
fs::path usual_folder() {
    if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data)
        return fs::path(data) / "item3d" / "studio";
    const char* home = std::getenv("HOME");
    if (!home || !*home)
        throw InputError("--folder", "no home folder was found for the projects", "give a folder");
    return fs::path(home) / ".local/share/item3d/studio";
}

/// Returns the first of these folders that exists.
fs::path first_folder(const std::vector<fs::path>& candidates, const std::string& what) {
    for (const fs::path& folder : candidates)
        if (fs::is_directory(folder)) return fs::canonical(folder);
    throw InputError(candidates.front().string(), what + " does not exist", "install item3d again");
}

std::string read_password(const StudioCommandOptions& options) {
    constexpr std::size_t shortest = 8;
    if (options.password_file.empty()) {
        if (is_loopback(options.host)) return "";
        throw UsageError("--host " + options.host +
                         ": other machines can reach this address, so --password-file FILE is "
                         "required. The page is not encrypted: in a network that you do not trust, "
                         "leave --host out and use ssh -L, or a reverse proxy with HTTPS");
    }
    std::string password = read_text(options.password_file);
    password = password.substr(0, password.find_first_of("\r\n"));
    if (password.size() < shortest)
        throw InputError(
            options.password_file.string(),
            fmt::format("the password in its first line has {} characters", password.size()),
            fmt::format("use {} or more", shortest));
    return password;
}

StudioOptions studio_options(const StudioCommandOptions& given) {
    constexpr int token_bytes = 16, cookie_bytes = 4;
    StudioOptions options;
    options.folder = given.folder.empty() ? usual_folder() : given.folder;
    make_output_folder(options.folder);
    const fs::path assets = assets_folder();
    options.page = first_folder({assets / "web", assets / "../web"}, "the studio's page");
    options.three =
        first_folder({options.page / "three", options.page / "../.deps/three"}, "three.js");
    options.programs = programs_folder();
    options.access.token = random_secret(token_bytes);
    options.access.password = read_password(given);
    options.access.cookie = "item3d_" + random_secret(cookie_bytes);
    options.access.address = given.address;
    return options;
}

/// Opens the address with the desktop's opener, if there is one.
void open_browser(const std::string& address, const fs::path& log) {
    const fs::path opener = program_in_path("xdg-open");
    const bool has_desktop = std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
    if (opener.empty() || !has_desktop) return;
    ChildProgram program({opener.string(), address}, log);
    constexpr auto longest = std::chrono::seconds(5);
    const auto last = std::chrono::steady_clock::now() + longest;
    while (!program.status() && std::chrono::steady_clock::now() < last && !interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

/// Serves until Ctrl-C, which is a normal end.
void run_studio(const StudioCommandOptions& options) {
    set_verbosity(options.quiet ? Verbosity::quiet : Verbosity::normal);
    install_interrupt_handler();
    Studio studio(studio_options(options));
    const StudioServer server(studio, options.host, options.port);
    std::string query;
    if (studio.options().access.password.empty()) query = "?token=" + studio.options().access.token;
    if (!options.model.empty()) {
        const std::int64_t project = studio.open_again(options.model).id;
        query += (query.empty() ? "?project=" : "&project=") + std::to_string(project);
    }
    std::string address = options.address;
    while (address.ends_with('/'))
        address.pop_back();
    if (address.empty()) address = server_address(options.host, server.port());
    address += "/" + query;
    if (!is_loopback(options.host))
        note(
            "other machines can reach this page with its password and without encryption; anyone "
            "with the password can run edits and read the results");
    fmt::print("{}\n", address);
    if (std::fflush(stdout) != 0) throw ResourceError("stdout: cannot be written");
    note("serving until Ctrl-C; projects are in " + studio.options().folder.string());
    if (!options.no_browser) open_browser(address, studio.options().folder / "browser.log");
    while (!interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    note("ended; running jobs were paused and can be resumed");
}

}  // namespace

void add_studio_command(CLI::App& app) {
    auto options = std::make_shared<StudioCommandOptions>();
    CLI::App* command =
        app.add_subcommand("studio", std::string(find_command("studio")->description));
    use_help(*command, command_help("studio"));
    command->add_option("MODEL", options->model,
                        "Model to open: .glb, .gltf, .vrm, .obj or .zip. Default: the page lists "
                        "the models that were opened before");
    command
        ->add_option("--folder", options->folder,
                     "Folder of projects and results. Default: ~/.local/share/item3d/studio")
        ->type_name("FOLDER");
    command
        ->add_option("--host", options->host,
                     "Address to listen on. Other machines can reach any address but the default, "
                     "which then requires --password-file")
        ->type_name("ADDRESS")
        ->capture_default_str();
    command->add_option("--port", options->port, "Port to listen on; 0: any free port")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    command
        ->add_option("--password-file", options->password_file,
                     "File whose first line is the password of the page, instead of the token in "
                     "its address")
        ->type_name("FILE");
    command
        ->add_option("--address", options->address,
                     "Public address of the page behind a proxy: https://example.org/studio")
        ->type_name("URL");
    command->add_flag("--no-browser", options->no_browser,
                      "Print the address without opening a browser");
    command->add_flag("--quiet", options->quiet, "Print warnings and errors only")
        ->group("Common options");
    command->callback([options] { run_studio(*options); });
}

}  // namespace item3d
