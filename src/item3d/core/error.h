// The few exception types that cross item3d's boundaries, and the check for programmer mistakes.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace item3d {

/// Exit codes of every command (docs/formats.md).
enum class ExitCode {
    done = 0,
    bug = 1,
    usage = 2,
    bad_input = 3,
    no_resource = 4,
    // The codes of `item3d provenance` alone.
    altered = 5,
    other_signer = 6,
    not_signed = 7,
    interrupted = 130
};

/// Base of all errors that a user can cause and mend. what() is one line.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

/// A file or value that can't be used. The message reads "SUBJECT: PROBLEM; HINT".
class InputError : public Error {
  public:
    /// subject: the file or option; problem: what was expected and found; hint: what to try.
    InputError(const std::string& subject, const std::string& problem, const std::string& hint = "")
        : Error(ExitCode::bad_input, subject + ": " + problem + (hint.empty() ? "" : "; " + hint)) {
    }
};

/// Wrong usage of the command line.
class UsageError : public Error {
  public:
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// A missing or spent resource: disk, memory, device.
class ResourceError : public Error {
  public:
    explicit ResourceError(const std::string& message) : Error(ExitCode::no_resource, message) {}
};

/// Ctrl-C or SIGTERM, thrown from a safe point after what must be kept was written.
class Interrupted : public Error {
  public:
    explicit Interrupted(const std::string& message) : Error(ExitCode::interrupted, message) {}
};

[[noreturn]] void check_failed(const char* expression, const char* file, int line,
                               const std::string& detail);

}  // namespace item3d

/// States what must hold unless our own code is wrong; throws std::logic_error with both the
/// expression and the detail (any expression that makes a std::string) when it does not.
#define ITEM3D_CHECK(condition, detail)                                       \
    do {                                                                      \
        if (!(condition)) [[unlikely]]                                        \
            ::item3d::check_failed(#condition, __FILE__, __LINE__, (detail)); \
    } while (false)
