#include "item3d/batch/supervisor.h"

#include "item3d/batch/batch_view.h"
#include "item3d/core/available_memory.h"
#include "item3d/core/child_program.h"
#include "item3d/core/disk_full.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"

#include <sched.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double first_guess_bytes = 2e9;
constexpr auto growing_time = std::chrono::seconds(30);
constexpr auto look_every = std::chrono::seconds(2);
constexpr auto nap = std::chrono::milliseconds(100);
constexpr auto longest_farewell = std::chrono::seconds(300);
constexpr int max_vain_deaths = 5;  ///< maximum worker failures without a finished job

/// Returns the last line of the log that has an error; "" if there is none.
std::string last_error(const fs::path& log) {
    std::error_code code;
    if (!fs::exists(log, code)) return "";
    std::istringstream lines(read_text(log));
    std::string reason;
    constexpr std::string_view mark = "item3d: error: ";
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(mark)) reason = line.substr(mark.size());
    return reason;
}

struct LocalWorker {
    fs::path log;
    /// Null if the worker is to be started, or has ended for good.
    std::unique_ptr<ChildProgram> program;
    Clock::time_point begin;
    bool has_ended = false;
};

/// Returns the numbers of the cores that this process may use; empty if unknown.
std::vector<int> usable_core_numbers() {
    std::vector<int> numbers;
    cpu_set_t cores;
    if (::sched_getaffinity(0, sizeof(cores), &cores) != 0) return numbers;
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &cores)) numbers.push_back(core);
    return numbers;
}

class Supervisor {
  public:
    Supervisor(const BatchFolder& folder, const SupervisorOptions& options)
        : options_(options), view_(folder), workers_(static_cast<std::size_t>(options.workers)) {
        for (std::size_t i = 0; i < workers_.size(); ++i)
            workers_[i].log = folder.workers() / fmt::format("log-{}.txt", i + 1);
        threads_ =
            options.threads > 0 ? options.threads : std::max(1, usable_cores() / options.workers);
    }

    void run() {
        Progress progress("batch", static_cast<std::int64_t>(total()),
                          static_cast<std::int64_t>(total() - view_.open_count()));
        while (view_.open_count() > 0) {
            if (interrupted()) {
                progress.finish();
                end_all();
                view_.refresh();
                throw Interrupted(
                    fmt::format("{} of {} jobs have ended; run the same command again to continue",
                                total() - view_.open_count(), total()));
            }
            look(progress);
            if (!start_and_reap()) break;
            std::this_thread::sleep_for(nap);
        }
        wait_for_the_last();
        view_.refresh();
        show(progress);
    }

  private:
    std::size_t total() const {
        return static_cast<std::size_t>(
            std::count_if(view_.entries().begin(), view_.entries().end(),
                          [](const BatchEntry& entry) { return entry.is_current(); }));
    }

    void look(Progress& progress) {
        if (Clock::now() - looked_ < look_every) return;
        looked_ = Clock::now();
        for (const std::size_t index : view_.refresh().told) {
            const BatchEntry& entry = view_.entry(index);
            if (!entry.is_finished()) continue;
            vain_deaths_ = 0;
            if (entry.last.outcome.is_object())
                largest_ = std::max(largest_, entry.last.outcome.value("peak_memory_bytes", 0.0));
        }
        show(progress);
    }

    void show(Progress& progress) const {
        const auto failed = std::count_if(
            view_.entries().begin(), view_.entries().end(), [](const BatchEntry& entry) {
                return entry.is_current() && entry.state == JobState::failed;
            });
        progress.update(static_cast<std::int64_t>(total() - view_.open_count()),
                        failed > 0 ? fmt::format("{} failed", failed) : "");
    }

    /// Starts workers, and takes note of those that have ended. Returns false if no worker runs or
    /// will run.
    bool start_and_reap() {
        bool may_go_on = false;
        for (std::size_t i = 0; i < workers_.size(); ++i) {
            LocalWorker& worker = workers_[i];
            if (worker.program) {
                if (const auto status = worker.program->status()) reap(worker, *status);
            } else if (!worker.has_ended && may_start()) {
                start(worker, i);
            }
            may_go_on = may_go_on || !worker.has_ended;
        }
        if (!may_go_on && !full_.empty()) throw DiskFull(full_);
        return may_go_on;
    }

    bool may_start() const {
        std::size_t running = 0, young = 0;
        for (const LocalWorker& worker : workers_) {
            if (!worker.program) continue;
            ++running;
            // A recently started worker has not taken all of its memory yet.
            if (Clock::now() - worker.begin < growing_time) ++young;
        }
        const double wanted = largest_ > 0 ? largest_ : first_guess_bytes;
        return running == 0 || available_memory() > wanted * static_cast<double>(1 + young);
    }

    void start(LocalWorker& worker, std::size_t index) {
        std::vector<std::string> command = options_.command;
        command.insert(command.end(),
                       {"--index", std::to_string(index), "--threads", std::to_string(threads_)});
        worker.program = std::make_unique<ChildProgram>(command, worker.log,
                                                        ChildSurroundings{{}, {}, cores_of(index)});
        worker.begin = Clock::now();
    }

    /// Returns the cores reserved for a worker. They keep the worker from moving to another core,
    /// whose caches would be cold. Empty if the batch uses fewer cores than all, because two
    /// batches would reserve the same ones.
    std::vector<int> cores_of(std::size_t index) const {
        const std::vector<int> all = usable_core_numbers();
        const auto threads = static_cast<std::size_t>(threads_);
        if (threads * workers_.size() != all.size()) return {};
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(index * threads);
        return {first, first + threads_};
    }

    void reap(LocalWorker& worker, int status) {
        worker.program.reset();
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        if (code == static_cast<int>(ExitCode::done)) {
            worker.has_ended = true;
            return;
        }
        const std::string reason = last_error(worker.log);
        if (code == static_cast<int>(ExitCode::no_resource) &&
            reason.find("no more jobs are claimed") != std::string::npos) {
            full_ = reason;
            worker.has_ended = true;
            return;
        }
        // A death by SIGKILL does not count: the next worker need not die too, and each job counts
        // the deaths of its own workers.
        const bool was_killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
        if (!was_killed && ++vain_deaths_ > max_vain_deaths)
            throw ResourceError(worker.log.string() +
                                ": workers repeatedly end without finishing a job: " +
                                (reason.empty() ? "see the log" : reason));
        warn(fmt::format("a worker ended ({}); another one replaces it",
                         WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                         : reason.empty()    ? fmt::format("code {}", code)
                                             : reason));
    }

    void end_all() {
        for (LocalWorker& worker : workers_)
            if (worker.program) worker.program->ask_to_end();
        wait(longest_farewell);
    }

    /// Waits for the remaining workers, which end when no jobs are left.
    void wait_for_the_last() { wait(longest_farewell); }

    void wait(Clock::duration longest) {
        const auto last = Clock::now() + longest;
        for (LocalWorker& worker : workers_)
            while (worker.program && !worker.program->status() && Clock::now() < last)
                std::this_thread::sleep_for(nap);
        for (LocalWorker& worker : workers_)
            worker.program.reset();
    }

    const SupervisorOptions& options_;
    BatchView view_;
    std::vector<LocalWorker> workers_;
    int threads_ = 1;
    int vain_deaths_ = 0;
    std::string full_;    ///< reason of workers that stopped for lack of space; "" if none did
    double largest_ = 0;  ///< maximum memory of a job, in bytes
    Clock::time_point looked_;
};

}  // namespace

int usable_cores() {
    const std::size_t told = usable_core_numbers().size();
    return static_cast<int>(told > 0 ? told : std::max(1u, std::thread::hardware_concurrency()));
}

void supervise(const BatchFolder& folder, const SupervisorOptions& options) {
    Supervisor(folder, options).run();
}

}  // namespace item3d
