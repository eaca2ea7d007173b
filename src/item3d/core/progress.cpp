#include "item3d/core/progress.h"

#include "item3d/core/progress_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace item3d {
namespace {

// Process-wide by nature: there is one stderr.
Verbosity current_verbosity = Verbosity::normal;

}  // namespace

void set_verbosity(Verbosity verbosity) {
    current_verbosity = verbosity;
}
Verbosity verbosity() {
    return current_verbosity;
}

void note(const std::string& message) {
    if (current_verbosity != Verbosity::quiet) fmt::print(stderr, "{}\n", message);
}

void warn(const std::string& message) {
    fmt::print(stderr, "warning: {}\n", message);
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
      shown_(start_),
      terminal_(::isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    finish();
}

void Progress::update(std::int64_t done, const std::string& detail) {
    done_ = done;
    detail_ = detail;
    const auto now = Clock::now();
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
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const double rate = seconds > 0 ? static_cast<double>(done - first_) / seconds : 0.0;
    const std::string time =
        last       ? format_duration(seconds)
        : rate > 0 ? format_duration(static_cast<double>(total_ - done) / rate) + " left"
                   : "";
    const std::string tail = detail.empty() ? "" : "  " + detail;
    if (terminal_) {
        constexpr int width = 28;
        const int filled =
            total_ > 0 ? static_cast<int>(std::clamp<std::int64_t>(done * width / total_, 0, width))
                       : width;
        fmt::print(stderr, "\r\033[K{:8} {}{} {}/{}  {:.1f}/s  {}{}{}", label_,
                   std::string(static_cast<std::size_t>(filled), '#'),
                   std::string(static_cast<std::size_t>(width - filled), '.'), done, total_, rate,
                   time, tail, last ? "\n" : "");
        std::fflush(stderr);
    } else {
        fmt::print(stderr, "{}: {}/{}  {:.1f}/s  {}{}\n", label_, done, total_, rate, time, tail);
    }
}

}  // namespace item3d
