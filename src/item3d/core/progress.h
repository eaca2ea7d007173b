// What a command tells people while it works: all of it on stderr, results alone go to stdout.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace item3d {

/// How much is said on stderr. Set once by main() from --quiet; read by Progress, note and warn.
enum class Verbosity { quiet, normal };
void set_verbosity(Verbosity verbosity);
Verbosity verbosity();

/// One line of information ("edit: the UV map overlaps, so xatlas made a new one").
void note(const std::string& message);
/// One line that starts with "warning: ". Shown even when quiet.
void warn(const std::string& message);

/// Keeps the warnings of this process while it lives.
class CollectedWarnings {
  public:
    CollectedWarnings();
    ~CollectedWarnings();
    CollectedWarnings(const CollectedWarnings&) = delete;
    CollectedWarnings& operator=(const CollectedWarnings&) = delete;

    /// Each once, in the order in which they came.
    std::vector<std::string> lines() const;

  private:
    friend void warn(const std::string& message);
    void add(const std::string& message);

    CollectedWarnings* outer_;
    mutable std::mutex mutex_;
    std::vector<std::string> lines_;
};

/// A bar with rate and time left on a terminal; a plain line every ten seconds elsewhere.
class Progress {
  public:
    /// label: "edit", "fit", ...; total: how many steps there will be; done: how many a resumed
    /// run has behind it.
    Progress(std::string label, std::int64_t total, std::int64_t done = 0);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Says that `done` steps are behind us; detail ("loss 0.12") stands at the line's end.
    void update(std::int64_t done, const std::string& detail = "");
    /// Ends the line; called by the destructor too.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    void print(std::int64_t done, const std::string& detail, bool last);

    std::string label_;
    std::int64_t total_;
    std::int64_t first_;
    std::int64_t done_;
    std::string detail_;
    Clock::time_point start_;
    Clock::time_point stepped_;  ///< when done_ changed last
    Clock::time_point shown_;
    bool terminal_;
    bool finished_ = false;
};

/// "3 s", "2 min 05 s", "1 h 10 min".
std::string format_duration(double seconds);

/// Becomes true after Ctrl-C, SIGTERM or SIGHUP once install_interrupt_handler was called. Loops
/// poll it at safe points. A second Ctrl-C ends the program at once.
void install_interrupt_handler();
bool interrupted();

}  // namespace item3d
