#include "apps/item3d/run.h"

#include "item3d/core/format.h"
#include "item3d/tensors/process.h"

#include <c10/util/Exception.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

namespace item3d {
namespace {

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// True for messages that memory is exhausted, for which LibTorch has no exception type. They come
/// from its CPU allocator, and from oneDNN if it cannot allocate a convolution's code or buffers.
bool says_out_of_memory(const std::string& message) {
    return message.find("can't allocate memory") != std::string::npos ||
           message.find("not enough memory") != std::string::npos ||
           message == "could not create a primitive" || message == "could not execute a primitive";
}

/// Returns the text for fail_out_of_memory() with the size in LibTorch's message ("allocate N
/// bytes").
std::string lacking_memory(const std::string& message) {
    constexpr std::string_view before = "allocate ";
    if (const std::size_t at = message.find(before); at != std::string::npos) {
        const double bytes = std::strtod(message.c_str() + at + before.size(), nullptr);
        if (bytes > 0) return fmt::format(" ({:.3g} GB more were needed)", bytes / 1e9);
    }
    return "";
}

}  // namespace

void run_program(int argc, char** argv, std::initializer_list<AddCommand> add_commands) {
    // A file at its size limit must be an error of write(), not a signal.
    std::signal(SIGXFSZ, SIG_IGN);
    prepare_process();
    const int code = guarded([&] {
        try {
            return parse_and_run(argc, argv, add_commands);
        } catch (const c10::Error& error) {
            const std::string message = first_line(error.what_without_backtrace());
            if (says_out_of_memory(message)) return fail_out_of_memory(lacking_memory(message));
            return fail_as_bug(message);
        } catch (const std::exception& error) {
            if (says_out_of_memory(error.what())) return fail_out_of_memory("");
            throw;
        }
    });
    // The process ends here, because LibTorch takes a tenth of a second to unregister its
    // operators.
    end_program(code);
}

}  // namespace item3d
