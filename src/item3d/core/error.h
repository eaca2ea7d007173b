// The exception types of item3d's interfaces, and the check for programming errors.
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
    // Exit codes of `item3d provenance` only.
    altered = 5,
    other_signer = 6,
    not_signed = 7,
    interrupted = 130
};

/// Base of all errors that a user can cause and fix. what() is one line.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

/// Unusable file or value. The message reads "SUBJECT: PROBLEM; HINT".
class InputError : public Error {
  public:
    /// subject: the file or option; problem: expected and actual value; hint: remedy.
    InputError(const std::string& subject, const std::string& problem, const std::string& hint = "")
        : Error(ExitCode::bad_input, subject + ": " + problem + (hint.empty() ? "" : "; " + hint)) {
    }
};

/// Wrong usage of the command line.
class UsageError : public Error {
  public:
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// Missing or exhausted resource: disk, memory, device.
class ResourceError : public Error {
  public:
    explicit ResourceError(const std::string& message) : Error(ExitCode::no_resource, message) {}
};

/// Stop by Ctrl-C or SIGTERM. Thrown from a safe point after the state was saved.
class Interrupted : public Error {
  public:
    explicit Interrupted(const std::string& message) : Error(ExitCode::interrupted, message) {}
};

/// Returns the message of an exception. For an error of std::filesystem, it names the path, the
/// reason and a remedy, as the message of an InputError does.
std::string message_of(const std::exception& error);

[[noreturn]] void check_failed(const char* expression, const char* file, int line,
                               const std::string& detail);

}  // namespace item3d

/// Asserts an invariant. If it does not hold, throws std::logic_error with the expression and the
/// detail (any expression that makes a std::string).
#define ITEM3D_CHECK(condition, detail)                                       \
    do {                                                                      \
        if (!(condition)) [[unlikely]]                                        \
            ::item3d::check_failed(#condition, __FILE__, __LINE__, (detail)); \
    } while (false)
