#include "apps/item3d/run.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/tensors/process.h"

#include <c10/util/Exception.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

namespace item3d {
namespace {

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

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// LibTorch says that the CPU's memory is spent in words alone.
bool says_out_of_memory(const std::string& message) {
    return message.find("can't allocate memory") != std::string::npos ||
           message.find("not enough memory") != std::string::npos;
}

/// LibTorch's message names the size that it lacked ("allocate N bytes").
int fail_out_of_memory(const std::string& message) {
    constexpr std::string_view before = "allocate ";
    std::string lacking;
    if (const std::size_t at = message.find(before); at != std::string::npos) {
        const double bytes = std::strtod(message.c_str() + at + before.size(), nullptr);
        if (bytes > 0) lacking = fmt::format(" ({:.3g} GB more were wanted)", bytes / 1e9);
    }
    return fail(ExitCode::no_resource, "error: out of memory" + lacking +
                                           "; close other programs, or choose smaller pictures "
                                           "or fewer at a time");
}

/// "item3d edit", as far as the command line got.
std::string command_of(const CLI::App& app) {
    std::string command = app.get_name();
    const CLI::App* deepest = &app;
    while (!deepest->get_subcommands().empty()) {
        deepest = deepest->get_subcommands().front();
        command += " " + deepest->get_name();
    }
    return command;
}

int parse_and_run(int argc, char** argv, std::initializer_list<AddCommand> add_commands) {
    CLI::App app("Edits the look of textured 3D models from two sentences.", "item3d");
    app.require_subcommand(1);
    for (const AddCommand add_command : add_commands)
        add_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // --help comes this way too; it is no error.
        if (error.get_exit_code() == 0) return app.exit(error);
        return fail(ExitCode::usage, std::string("error: ") + error.what() + "; `" +
                                         command_of(app) + " --help` lists the options");
    }
    return static_cast<int>(ExitCode::done);
}

int code_of(int argc, char** argv, std::initializer_list<AddCommand> add_commands) {
    try {
        return parse_and_run(argc, argv, add_commands);
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
    } catch (const c10::Error& error) {
        const std::string message = first_line(error.what_without_backtrace());
        if (says_out_of_memory(message)) return fail_out_of_memory(message);
        return fail_as_bug(message);
    } catch (const std::exception& error) {
        return fail_as_bug(error.what());
    } catch (...) {
        return fail_as_bug("an exception of unknown type");
    }
}

}  // namespace

void run_program(int argc, char** argv, std::initializer_list<AddCommand> add_commands) {
    // A file that may not grow any more is an error of write(), not the end of the program.
    std::signal(SIGXFSZ, SIG_IGN);
    prepare_process();
    const int code = code_of(argc, argv, add_commands);
    // LibTorch would take a tenth of a second to forget its operators one by one.
    std::fflush(nullptr);
    std::_Exit(code);
}

}  // namespace item3d
