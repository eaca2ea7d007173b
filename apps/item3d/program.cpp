#include "apps/item3d/program.h"

#include "apps/item3d/help.h"
#include "apps/item3d/help_description.h"
#include "item3d/core/format.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

namespace item3d {
namespace {

/// Option for scripts/reference.py, hidden from users.
constexpr std::string_view describe_commands = "--describe-commands";

/// Returns "item3d edit", as far as the command line was parsed.
std::string command_of(const CLI::App& app) {
    std::string command = app.get_name();
    const CLI::App* deepest = &app;
    while (!deepest->get_subcommands().empty()) {
        deepest = deepest->get_subcommands().front();
        command += " " + deepest->get_name();
    }
    return command;
}

}  // namespace

int fail(ExitCode code, std::string message) {
    for (char& character : message) {
        if (character == '\n' || character == '\r') character = ' ';
    }
    fmt::print(stderr, "item3d: {}\n", message);
    return static_cast<int>(code);
}

int fail_as_bug(const std::string& message) {
    return fail(ExitCode::bug,
                "error: " + message + " (this is a bug of item3d: please report it)");
}

int fail_out_of_memory(const std::string& lacking) {
    return fail(ExitCode::no_resource, "error: out of memory" + lacking +
                                           "; close other programs, or choose smaller pictures "
                                           "or fewer at a time");
}

int parse_and_run(int argc, char** argv, std::initializer_list<AddCommand> add_commands) {
    CLI::App app("Edits the look of textured 3D models from two sentences.", "item3d");
    app.require_subcommand(1);
    use_help(app, {});
    for (const AddCommand add_command : add_commands)
        add_command(app);
    if (argc == 2 && argv[1] == describe_commands) {
        fmt::print("{}\n", command_description(app)["commands"].dump());
        return static_cast<int>(ExitCode::done);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // --help comes this way too; it is not an error.
        if (error.get_exit_code() == 0) return app.exit(error);
        return fail(ExitCode::usage, std::string("error: ") + error.what() + "; `" +
                                         command_of(app) + " --help` lists the options");
    }
    return static_cast<int>(ExitCode::done);
}

int guarded(const std::function<int()>& run) {
    try {
        return run();
    } catch (const Interrupted& stop) {
        return fail(stop.code(), std::string("interrupted: ") + stop.what());
    } catch (const Error& error) {
        return fail(error.code(), std::string("error: ") + error.what());
    } catch (const std::bad_alloc&) {
        return fail_out_of_memory("");
    } catch (const std::filesystem::filesystem_error& error) {
        const bool full = error.code() == std::errc::no_space_on_device;
        return fail(full ? ExitCode::no_resource : ExitCode::bad_input,
                    std::string("error: ") + error.what());
    } catch (const std::exception& error) {
        return fail_as_bug(error.what());
    } catch (...) {
        return fail_as_bug("an exception of unknown type");
    }
}

void end_program(int code) {
    std::fflush(nullptr);
    std::_Exit(code);
}

}  // namespace item3d
