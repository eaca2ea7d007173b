// item3d: reads the command line, runs one command, and turns what it throws into an exit code.
#include "command.h"
#include "commands.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/version.h"

#include <malloc.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

namespace {

using item3d::ExitCode;

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

int run(int argc, char** argv) {
    CLI::App app("Edits the look of textured 3D models from two sentences.", "item3d");
    app.set_version_flag("--version", fmt::format("item3d {}", item3d::version()));
    app.require_subcommand(1);
    item3d::add_commands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // --help and --version come this way too; they are no errors.
        return app.exit(error) == 0 ? static_cast<int>(ExitCode::done)
                                    : static_cast<int>(ExitCode::usage);
    }
    return static_cast<int>(ExitCode::done);
}

/// Large tensors come and go each iteration. Kept in the heap they are reused; given back to the
/// system each of their pages would be cleared anew.
void keep_large_blocks() {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace

int main(int argc, char** argv) {
    // A file that may not grow any more is an error of write(), not the end of the program.
    std::signal(SIGXFSZ, SIG_IGN);
    keep_large_blocks();
    try {
        return run(argc, argv);
    } catch (const item3d::Interrupted& stop) {
        return fail(stop.code(), std::string("interrupted: ") + stop.what());
    } catch (const item3d::Error& error) {
        return fail(error.code(), std::string("error: ") + error.what());
    } catch (const std::bad_alloc&) {
        return fail(ExitCode::no_resource, "error: out of memory");
    } catch (const std::filesystem::filesystem_error& error) {
        const bool full = error.code() == std::errc::no_space_on_device;
        return fail(full ? ExitCode::no_resource : ExitCode::bad_input,
                    std::string("error: ") + error.what());
    } catch (const c10::Error& error) {
        const std::string message = first_line(error.what_without_backtrace());
        if (says_out_of_memory(message)) {
            return fail(ExitCode::no_resource, "error: out of memory: " + message);
        }
        return fail_as_bug(message);
    } catch (const std::exception& error) {
        return fail_as_bug(error.what());
    } catch (...) {
        return fail_as_bug("an exception of unknown type");
    }
}
