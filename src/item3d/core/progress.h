// Messages and progress of a command on stderr; stdout is for results only.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace item3d {

/// Verbosity on stderr. Set once by main() from --quiet; read by Progress, note() and warn().
enum class Verbosity { quiet, normal };
void set_verbosity(Verbosity verbosity);
Verbosity verbosity();

/// Prints one line of information ("edit: the UV map overlaps, so xatlas made a new one").
void note(const std::string& message);
/// Prints one line that starts with "warning: ", even when quiet.
void warn(const std::string& message);

/// Collects all warnings that the process prints while this object exists.
class CollectedWarnings {
  public:
    CollectedWarnings();
    ~CollectedWarnings();
    CollectedWarnings(const CollectedWarnings&) = delete;
    CollectedWarnings& operator=(const CollectedWarnings&) = delete;

    /// Returns the warnings in order, each once.
    std::vector<std::string> lines() const;

  private:
    friend void warn(const std::string& message);
    void add(const std::string& message);

    CollectedWarnings* outer_;
    mutable std::mutex mutex_;
    std::vector<std::string> lines_;
};

/// Shows the progress with rate and remaining time: as a bar on a terminal, elsewhere as a line
/// every ten seconds.
class Progress {
  public:
    /// label: "edit", "fit", ...; total: number of steps; done: number of steps that the run
    /// finished before it was resumed.
    Progress(std::string label, std::int64_t total, std::int64_t done = 0);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Reports that `done` steps are finished. detail: printed at the line's end, such as "loss
    /// 0.12".
    void update(std::int64_t done, const std::string& detail = "");
    /// Ends the line. The destructor calls this function too.
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
    Clock::time_point stepped_;  ///< time of the last change of done_
    Clock::time_point shown_;
    bool terminal_;
    bool finished_ = false;
};

/// Returns "3 s", "2 min 05 s", "1 h 10 min".
std::string format_duration(double seconds);

/// After install_interrupt_handler(), interrupted() returns true once the process has received
/// Ctrl-C, SIGTERM or SIGHUP. Loops poll interrupted() at safe points. A second Ctrl-C ends the
/// program immediately.
void install_interrupt_handler();
bool interrupted();

}  // namespace item3d
