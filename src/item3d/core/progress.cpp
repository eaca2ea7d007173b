#include "item3d/core/progress.h"

#include "item3d/core/one_line.h"
#include "item3d/core/progress_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace item3d {
namespace {

// One verbosity for the whole process, because there is one stderr.
Verbosity current_verbosity = Verbosity::normal;
/// Head of the linked list of live collectors. It is the newest collector; each refers to the one
/// created before it.
CollectedWarnings* newest_warnings = nullptr;
std::mutex warnings_mutex;

/// Prints to stderr. Ignores errors, unlike fmt::print(), since a full or closed log must not end
/// the command.
void say(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

struct Pace {
    std::string text;  ///< "4.2/s", or "28 s each"
    double left = -1;  ///< seconds; negative before the first step
};

/// Returns the pace of `steps` steps that took `seconds`. idle: seconds since the last of them.
Pace pace_of(std::int64_t steps, std::int64_t to_do, double seconds, double idle) {
    if (steps <= 0 || seconds <= 0) return {};
    const double each = seconds / static_cast<double>(steps);
    return {each > 2 ? format_duration(each) + " each" : fmt::format("{:.1f}/s", 1 / each),
            std::max(0.0, each * static_cast<double>(to_do) - idle)};
}

}  // namespace

void set_verbosity(Verbosity verbosity) {
    current_verbosity = verbosity;
}
Verbosity verbosity() {
    return current_verbosity;
}

void note(const std::string& message) {
    if (current_verbosity != Verbosity::quiet) say(one_line(message) + "\n");
}

void warn(const std::string& message) {
    say("warning: " + one_line(message) + "\n");
    const std::lock_guard guard(warnings_mutex);
    for (CollectedWarnings* each = newest_warnings; each; each = each->outer_)
        each->add(message);
}

CollectedWarnings::CollectedWarnings() {
    const std::lock_guard guard(warnings_mutex);
    outer_ = newest_warnings;
    newest_warnings = this;
}

CollectedWarnings::~CollectedWarnings() {
    const std::lock_guard guard(warnings_mutex);
    CollectedWarnings** link = &newest_warnings;
    while (*link != this)
        link = &(*link)->outer_;
    *link = outer_;
}

std::vector<std::string> CollectedWarnings::lines() const {
    const std::lock_guard guard(mutex_);
    return lines_;
}

void CollectedWarnings::add(const std::string& message) {
    const std::lock_guard guard(mutex_);
    if (std::find(lines_.begin(), lines_.end(), message) == lines_.end()) lines_.push_back(message);
}

std::string format_duration(double seconds) {
    const auto whole = std::lround(seconds);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

Progress::Progress(std::string label, std::int64_t total, std::int64_t done)
    : label_(std::move(label)),
      total_(total),
      first_(done),
      done_(done),
      start_(Clock::now()),
      stepped_(start_),
      shown_(start_),
      terminal_(::isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    finish();
}

void Progress::update(std::int64_t done, const std::string& detail) {
    const auto now = Clock::now();
    if (done != done_) stepped_ = now;
    done_ = done;
    detail_ = detail;
    show_steps(label_, done - first_, done, total_,
               std::chrono::duration<double>(now - start_).count());
    const auto interval = terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(10);
    if (now - shown_ < interval) return;
    shown_ = now;
    print(done, detail, false);
}

void Progress::finish() {
    if (finished_) return;
    finished_ = true;
    print(done_, detail_, true);
}

void Progress::print(std::int64_t done, const std::string& detail, bool last) {
    if (current_verbosity == Verbosity::quiet) return;
    using Seconds = std::chrono::duration<double>;
    const auto now = Clock::now();
    const Pace pace = pace_of(done - first_, total_ - done, Seconds(stepped_ - start_).count(),
                              Seconds(now - stepped_).count());
    const std::string time = last             ? format_duration(Seconds(now - start_).count())
                             : pace.left >= 0 ? format_duration(pace.left) + " left"
                                              : "";
    std::string tail;
    for (const std::string& part : {pace.text, time, detail})
        if (!part.empty()) tail += "  " + one_line(part);
    if (terminal_) {
        constexpr int width = 28;
        const int filled =
            total_ > 0 ? static_cast<int>(std::clamp<std::int64_t>(done * width / total_, 0, width))
                       : width;
        say(fmt::format("\r\033[K{:8} {}{} {}/{}{}{}", one_line(label_),
                        std::string(static_cast<std::size_t>(filled), '#'),
                        std::string(static_cast<std::size_t>(width - filled), '.'), done, total_,
                        tail, last ? "\n" : ""));
    } else {
        say(fmt::format("{}: {}/{}{}\n", one_line(label_), done, total_, tail));
    }
}

}  // namespace item3d
