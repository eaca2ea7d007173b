#include "apps/item3d/program.h"

#include "apps/item3d/help.h"
#include "apps/item3d/help_description.h"
#include "item3d/core/format.h"
#include "item3d/core/one_line.h"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

namespace item3d {
namespace {

/// Option for scripts/reference.py, hidden from users.
constexpr std::string_view describe_commands = "--describe-commands";

/// Returns the command's full name, such as "item3d edit", as far as the command line was parsed.
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

int fail(ExitCode code, const std::string& message) {
    // fmt::print() would throw if stderr is full or closed.
    std::fprintf(stderr, "item3d: %s\n", one_line(message).c_str());
    return static_cast<int>(code);
}

int fail_as_bug(const std::string& message) {
    return fail(ExitCode::bug,
                "error: " + message + " (this is a bug of item3d: please report it)");
}

int fail_out_of_memory(const std::string& lacking) {
    return fail(ExitCode::no_resource,
                "error: out of memory" + lacking +
                    "; close other programs, or use smaller images or fewer at a time");
}

namespace {

/// Reports exhausted threads or descriptors, or an output that cannot be printed. Returns the exit
/// code.
int fail_without_system(const std::system_error& error) {
    if (std::ferror(stdout) != 0)
        return fail(ExitCode::no_resource,
                    "error: stdout: cannot be written: " + error.code().message());
    const std::string what = error.code() == std::errc::resource_unavailable_try_again
                                 ? "no thread or process could be started: "
                                 : "";
    return fail(ExitCode::no_resource,
                "error: " + what + error.what() +
                    "; a limit of the system was reached, close other programs and try again");
}

/// Ends the program with a message, without allocating. If memory is exhausted, destructors that
/// allocate (for example of JSON) terminate the program, and no catch block is reached.
[[noreturn]] void end_in_destructor() {
    try {
        if (const std::exception_ptr current = std::current_exception())
            std::rethrow_exception(current);
    } catch (const std::bad_alloc&) {
        std::fputs(
            "item3d: error: out of memory; close other programs, or use smaller images or fewer at "
            "a time\n",
            stderr);
        std::_Exit(static_cast<int>(ExitCode::no_resource));
    } catch (...) {
        // This is a mistake in the program. The library reports it and aborts.
    }
    __gnu_cxx::__verbose_terminate_handler();
    std::abort();
}

/// Opens a file in place of each closed standard stream. Otherwise the next opened file would take
/// the stream's number, and the program would print into it. Writing to the files opened here
/// fails, as with a closed stream.
void fill_standard_streams() {
    for (int stream = 0; stream <= 2; ++stream)
        if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) != stream) return;
}

}  // namespace

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
        // CLI11 also reports --help by this exception, which is not an error.
        if (error.get_exit_code() == 0) return app.exit(error);
        return fail(ExitCode::usage, std::string("error: ") + error.what() + "; `" +
                                         command_of(app) + " --help` lists the options");
    }
    return static_cast<int>(ExitCode::done);
}

int guarded(const std::function<int()>& run) {
    fill_standard_streams();
    std::set_terminate(end_in_destructor);
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
                    "error: " + message_of(error));
    } catch (const std::system_error& error) {
        return fail_without_system(error);
    } catch (const std::exception& error) {
        return fail_as_bug(error.what());
    } catch (...) {
        return fail_as_bug("an exception of unknown type");
    }
}

void end_program(int code) {
    const bool said = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (!said && code == static_cast<int>(ExitCode::done))
        code = fail(ExitCode::no_resource, std::string("error: stdout: cannot be written: ") +
                                               std::strerror(errno) +
                                               "; the files that were written are complete");
    std::fflush(nullptr);
    std::_Exit(code);
}

}  // namespace item3d
