#include "item3d/batch/worker.h"

#include "item3d/batch/batch_view.h"
#include "item3d/batch/heartbeat.h"
#include "item3d/batch/job_queue.h"
#include "item3d/batch/line_file.h"
#include "item3d/batch/time_limit.h"
#include "item3d/batch/worker_watch.h"
#include "item3d/core/disk_full.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"

#include <algorithm>
#include <optional>
#include <set>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr auto longest_nap = std::chrono::milliseconds(200);

class Worker {
  public:
    Worker(const BatchFolder& folder, const WorkerOptions& options, const JobRunner& run)
        : folder_(folder),
          options_(options),
          run_(run),
          view_(folder),
          heartbeat_(folder, options.beat_every),
          watch_(folder, options.stale_after),
          queue_(view_, version(), options.index) {
        const std::vector<std::size_t> begun = view_.begun();
        watched_.insert(begun.begin(), begun.end());
        for (std::size_t i = 0; i < view_.entries().size(); ++i)
            if (is_open(i) && !watched_.contains(i)) queue_.add(i);
        look_at_watched();
    }

    WorkerCounts work() {
        const TimeLimit limit(options_.until_seconds);
        Clock::time_point idle_since = Clock::now();
        while (view_.open_count() > 0) {
            if (interrupted()) throw Interrupted(summary());
            if (folder_.is_full()) throw disk_full(folder_.path().string() + ": the disk is full");
            if (Clock::now() - looked_ > options_.look_every) look_around();
            if (work_at_one()) {
                idle_since = Clock::now();
                continue;
            }
            const std::size_t foreign = queue_.open_foreign();
            if (foreign > 0 && foreign == view_.open_count())
                throw InputError(folder_.path().string(),
                                 "all remaining jobs were planned by another version of item3d",
                                 "run `item3d batch` with the jobs again, or use that version");
            const std::chrono::duration<double> idle = Clock::now() - idle_since;
            if (options_.idle_seconds >= 0 && idle.count() > options_.idle_seconds) break;
            std::this_thread::sleep_for(std::min(longest_nap, options_.look_every));
        }
        return counts_;
    }

  private:
    bool is_open(std::size_t index) const {
        const BatchEntry& entry = view_.entry(index);
        return entry.is_current() && !entry.is_finished();
    }

    const BatchJob& job_at(std::size_t index) const { return view_.entry(index).job; }

    std::string summary() const {
        return fmt::format("{} done, {} failed, {} released by this worker",
                           counted(counts_.done, "job"), counts_.failed, counts_.released);
    }

    DiskFull disk_full(const std::string& reason) const {
        return DiskFull(reason + " (no more jobs are claimed; " + summary() +
                        "; free some space and run the same command again)");
    }

    void look_around() {
        looked_ = Clock::now();
        const BatchView::News news = view_.refresh();
        for (const std::size_t index : news.added)
            if (is_open(index)) queue_.add(index);
        for (const std::size_t index : news.told)
            take_news(index);
        look_at_watched();
    }

    void take_news(std::size_t index) {
        const BatchEntry& entry = view_.entry(index);
        if (entry.is_finished()) {
            watched_.erase(index);
            watch_.forget(entry.job.id);
            queue_.finished(index);
        } else if (entry.last.worker != heartbeat_.worker()) {
            watched_.insert(index);
        }
    }

    /// Checks the jobs that other workers have begun. Such a job may be done, failed or released,
    /// or its worker may be lost.
    void look_at_watched() {
        const std::vector<std::size_t> all(watched_.begin(), watched_.end());
        for (const std::size_t index : all) {
            const FolderLook look = look_at(folder_.folder_of(job_at(index)));
            if (look.state == FolderState::done || look.state == FolderState::failed) {
                tell_finished(index, look.state);
            } else if (look.state == FolderState::waiting) {
                watched_.erase(index);
                // A job that ended with an error waits until the others have been tried.
                if (view_.entry(index).last.errors > 0)
                    queue_.add_retry(index);
                else
                    queue_.add_left(index);
            } else if (is_lost(index, look)) {
                watched_.erase(index);
                queue_.add_left(index);
            }
        }
    }

    bool is_lost(std::size_t index, const FolderLook& look) {
        return watch_.is_lost(job_at(index).id, look.worker, std::to_string(look.attempt));
    }

    /// Publishes the event of a finished job for its worker, which was killed after it had renamed
    /// the folder and before it wrote its journal line.
    void tell_finished(std::size_t index, FolderState state) {
        const fs::path job = folder_.folder_of(job_at(index));
        const bool is_done = state == FolderState::done;
        JobEvent event = read_event(is_done ? result_folder(job) : failed_folder(job));
        event.job = job_at(index).id;
        event.state = is_done ? JobState::done : JobState::failed;
        event.attempt = std::max(event.attempt, view_.entry(index).last.attempt);
        tell(event);
        take_news(index);
    }

    void tell(const JobEvent& event) {
        view_.tell(event);
        append_line(folder_.workers() / (heartbeat_.worker() + ".jsonl"),
                    json(event).dump(-1, ' ', false, json::error_handler_t::replace));
    }

    /// Claims and runs one job. Also makes the jobs fail that can never run. Returns false if there
    /// was nothing to claim.
    bool work_at_one() {
        for (const std::size_t index : queue_.take_hopeless())
            work_at(index);
        while (const auto index = queue_.next())
            if (work_at(*index)) return true;
        return false;
    }

    /// Claims and runs a job. Returns false if another worker has it.
    bool work_at(std::size_t index) {
        bool is_after_death = false;
        const std::optional<Claim> claim = claim_job(index, is_after_death);
        if (!claim) {
            watched_.insert(index);
            return false;
        }
        const BatchJob& job = job_at(index);
        watch_.forget(job.id);
        heartbeat_.set_job(job.id);
        JobEvent event = begin_event(job, *claim, heartbeat_.worker());
        if (is_after_death) ++event.deaths;
        const AttemptEnd end = run(job, *claim, std::move(event));
        heartbeat_.set_job("");
        take_end(index, end);
        return true;
    }

    std::optional<Claim> claim_job(std::size_t index, bool& is_after_death) {
        const fs::path job_folder = folder_.folder_of(job_at(index));
        if (auto claim = Claim::begin(job_folder, heartbeat_.worker())) return claim;
        const FolderLook look = look_at(job_folder);
        const bool is_another =
            look.state == FolderState::running || look.state == FolderState::empty;
        is_after_death = look.state == FolderState::running;
        if (look.state == FolderState::waiting || (is_another && is_lost(index, look)))
            return Claim::take(job_folder, look, heartbeat_.worker());
        return std::nullopt;
    }

    AttemptEnd run(const BatchJob& job, const Claim& claim, JobEvent event) {
        fs::path model = job.model;
        if (!job.after.empty()) {
            const auto before = view_.find(job.after);
            ITEM3D_CHECK(before, "a job is claimed before the one that it comes after");
            if (view_.entry(*before).state == JobState::failed)
                return give_up(
                    claim, std::move(event),
                    "the job that it comes after (" + title_of(job_at(*before)) + ") failed");
            model = model_in(result_folder(folder_.folder_of(job_at(*before))));
        }
        return run_attempt(job, model, claim, std::move(event), options_.limits, run_);
    }

    void take_end(std::size_t index, const AttemptEnd& end) {
        const BatchJob& job = job_at(index);
        if (end.is_lost) {
            ++counts_.lost;
            watched_.insert(index);
            warn(title_of(job) + ": another worker claimed it while this one was paused");
            return;
        }
        tell(end.event);
        switch (end.event.state) {
            case JobState::done:
                ++counts_.done;
                break;
            case JobState::failed:
                ++counts_.failed;
                warn(title_of(job) + ": failed: " + end.event.message);
                break;
            case JobState::waiting:
                ++counts_.released;
                if (end.stop == AttemptEnd::Stop::none) {
                    warn(title_of(job) + ": " + end.event.message + " (will be tried again)");
                    queue_.add_retry(index);
                }
                break;
        }
        if (end.event.state != JobState::waiting) queue_.finished(index);
        if (end.stop == AttemptEnd::Stop::disk_full) throw disk_full(end.reason);
        if (end.stop == AttemptEnd::Stop::interrupted) throw Interrupted(summary());
    }

    const BatchFolder& folder_;
    const WorkerOptions& options_;
    const JobRunner& run_;
    BatchView view_;
    Heartbeat heartbeat_;
    WorkerWatch watch_;
    JobQueue queue_;
    WorkerCounts counts_;
    std::set<std::size_t> watched_;  ///< jobs known to be begun by other workers
    Clock::time_point looked_ = Clock::now();
};

}  // namespace

WorkerCounts run_worker(const BatchFolder& folder, const WorkerOptions& options,
                        const JobRunner& run) {
    return Worker(folder, options, run).work();
}

fs::path model_in(const fs::path& folder) {
    std::error_code code;
    for (const char* name : {"model.glb", "model.vrm"})
        if (fs::exists(folder / name, code)) return folder / name;
    return {};
}

}  // namespace item3d
