#include "item3d/reconstruct/dataset/colmap_program.h"

#include "item3d/core/child_program.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"

#include <sys/wait.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <thread>

namespace item3d {

namespace {

namespace fs = std::filesystem;

/// Returns the line without a heading's markup or glog's date. Returns "" for stack traces and
/// empty lines.
std::string without_decoration(std::string line) {
    const auto first = std::find_if(line.begin(), line.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '@' || c == '*';
    });
    if (first == line.end() || *first == '@' || *first == '*') return {};
    line.erase(line.begin(), first);
    // Format of glog: F20260131 12:00:00.000000 1234 file.cc:10] message
    const std::size_t date = line.find("] ");
    const bool is_dated = line.size() > 2 && std::isdigit(static_cast<unsigned char>(line[1])) != 0;
    if (is_dated && date != std::string::npos) line.erase(0, date + 2);
    return line.substr(0, 200);
}

bool speaks_of_error(const std::string& line) {
    for (const char* word : {"ERROR", "rror:", "Check failed", "what():", "ailed to"})
        if (line.find(word) != std::string::npos) return true;
    return false;
}

/// Lines that a step appends to the log, read while the step runs.
class StepLog {
  public:
    StepLog(fs::path file, std::string counted)
        : file_(std::move(file)), counted_(std::move(counted)) {
        std::error_code code;
        const std::uintmax_t size = fs::file_size(file_, code);
        at_ = code ? 0 : static_cast<std::streamoff>(size);
    }
    /// Reads new complete lines.
    void read_on() {
        std::ifstream text(file_);
        text.seekg(at_);
        for (std::string line; std::getline(text, line) && !text.eof();) {
            at_ += static_cast<std::streamoff>(line.size() + 1);
            count_ += line.find(counted_) != std::string::npos;
            line = without_decoration(line);
            if (speaks_of_error(line)) error_ = line;
            if (!line.empty()) last_ = line;
        }
    }
    std::int64_t count() const { return count_; }
    /// Returns the last line with an error. If there is none, returns the last non-empty line.
    std::string telling() const {
        if (!error_.empty()) return error_;
        return last_.empty() ? "no message" : last_;
    }

  private:
    fs::path file_;
    std::string counted_;
    std::streamoff at_ = 0;
    std::int64_t count_ = 0;
    std::string last_, error_;
};

/// Runs a program. Calls `meanwhile` periodically while the program runs, and once after its end.
/// Returns waitpid()'s status.
int wait_for(const std::vector<std::string>& arguments, const fs::path& output,
             const std::function<void()>& meanwhile) {
    ChildProgram child(arguments, output);
    std::chrono::milliseconds pause(2);
    for (;;) {
        const std::optional<int> status = child.status();
        meanwhile();
        if (status) return *status;
        if (interrupted()) throw Interrupted("while COLMAP estimated the poses");
        std::this_thread::sleep_for(pause);
        pause = std::min(2 * pause, std::chrono::milliseconds(200));
    }
}

}  // namespace

ColmapProgram::ColmapProgram(fs::path program, fs::path log, int threads)
    : program_(std::move(program)), log_(std::move(log)), threads_(threads > 0 ? threads : -1) {}

ColmapOutcome ColmapProgram::run(const ColmapStep& step) const {
    std::vector<std::string> arguments{program_.string(), step.command};
    arguments.insert(arguments.end(), step.arguments.begin(), step.arguments.end());
    Progress progress(step.label, step.total);
    StepLog log(log_, step.counted);
    const int status = wait_for(arguments, log_, [&] {
        log.read_on();
        progress.update(std::min(log.count(), step.total));
    });
    progress.finish();
    if (!WIFSIGNALED(status)) return {WEXITSTATUS(status), log.telling()};
    const int signal = WTERMSIG(status);
    throw ResourceError(fmt::format(
        "colmap {} was ended by signal {} ({}): {}; its log is {}{}", step.command, signal,
        ::strsignal(signal), log.telling(), log_.string(),
        signal == SIGKILL ? "; memory may have run out, use fewer --threads or smaller images"
                          : ""));
}

void ColmapProgram::check(const ColmapStep& step, const ColmapOutcome& outcome) const {
    if (outcome.exit_code == 0) return;
    throw ResourceError(fmt::format("colmap {} failed (exit code {}): {}; its log is {}",
                                    step.command, outcome.exit_code, outcome.telling,
                                    log_.string()));
}

void ColmapProgram::add_device(ColmapStep& step, const std::string& now, const std::string& before,
                               const fs::path& scratch) const {
    write_atomically(scratch, std::string_view());
    wait_for({program_.string(), step.command, "-h"}, scratch, [] {});
    const std::string help = read_text(scratch);
    const auto add = [&](const std::string& name, int value) {
        const std::string option = "--" + now + "." + name;
        const bool is_new = help.find(option) != std::string::npos;
        step.arguments.push_back(is_new ? option : "--" + before + "." + name);
        step.arguments.push_back(std::to_string(value));
    };
    add("use_gpu", 0);
    add("num_threads", threads_);
}

}  // namespace item3d
