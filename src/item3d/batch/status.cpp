#include "item3d/batch/status.h"

#include "item3d/batch/attempt.h"
#include "item3d/batch/claim.h"
#include "item3d/batch/process_mark.h"
#include "item3d/batch/worker_watch.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/progress.h"

namespace item3d {
namespace {

using nlohmann::json;

RunningJob running_job(const BatchFolder& folder, std::size_t index, const BatchJob& job,
                       const FolderLook& look) {
    RunningJob running{index, look.worker, look.attempt};
    const json heart = read_heartbeat(folder.workers() / (look.worker + ".json"));
    if (!heart.is_object()) return running;
    running.has_ended =
        heart.value("ended", false) || has_ended(heart.value("process", json::object()));
    if (heart.value("job", "") == job.id) running.beat = heart.value("beat", std::int64_t(0));
    return running;
}

/// Returns the event of a published job that has no journal line.
JobEvent untold_event(const BatchFolder& folder, const BatchJob& job, FolderState state) {
    const auto job_folder = folder.folder_of(job);
    const bool is_done = state == FolderState::done;
    JobEvent event = read_event(is_done ? result_folder(job_folder) : failed_folder(job_folder));
    event.job = job.id;
    event.state = is_done ? JobState::done : JobState::failed;
    return event;
}

}  // namespace

BatchStatus status_of(const BatchFolder& folder, BatchView& view) {
    BatchStatus status;
    for (const std::size_t index : view.begun()) {
        const BatchJob& job = view.entry(index).job;
        const FolderLook look = look_at(folder.folder_of(job));
        if (look.state == FolderState::done || look.state == FolderState::failed)
            view.tell(untold_event(folder, job, look.state));
        else if (look.state == FolderState::waiting)
            ++status.released;
        else if (look.state != FolderState::absent)
            status.running.push_back(running_job(folder, index, job, look));
    }
    for (std::size_t i = 0; i < view.entries().size(); ++i) {
        const BatchEntry& entry = view.entry(i);
        if (!entry.is_current()) continue;
        ++status.jobs;
        const int ends = entry.last.errors + entry.last.deaths;
        if (ends > (entry.state == JobState::failed ? 1 : 0)) ++status.retried;
        if (!entry.last.warnings.empty()) status.warned.push_back(i);
        status.seconds += entry.last.seconds;
        if (entry.state == JobState::done) ++status.done;
        if (entry.state == JobState::failed) {
            ++status.failed;
            status.failures.push_back(i);
        }
    }
    status.waiting = status.jobs - status.done - status.failed - status.running.size();
    return status;
}

json status_json(const BatchStatus& status, const BatchView& view) {
    json running = json::array(), failures = json::array(), warned = json::array();
    for (const RunningJob& job : status.running)
        running.push_back({{"job", title_of(view.entry(job.index).job)},
                           {"folder", view.entry(job.index).job.folder},
                           {"worker", job.worker},
                           {"attempt", job.attempt},
                           {"beat", job.beat},
                           {"worker_has_ended", job.has_ended}});
    for (const std::size_t index : status.warned)
        warned.push_back({{"job", title_of(view.entry(index).job)},
                          {"folder", view.entry(index).job.folder},
                          {"warnings", view.entry(index).last.warnings}});
    for (const std::size_t index : status.failures)
        failures.push_back({{"job", title_of(view.entry(index).job)},
                            {"folder", view.entry(index).job.folder},
                            {"attempts", view.entry(index).last.attempt},
                            {"message", view.entry(index).last.message}});
    return {{"jobs", status.jobs},         {"waiting", status.waiting}, {"running", running},
            {"done", status.done},         {"failed", failures},        {"retried", status.retried},
            {"released", status.released}, {"seconds", status.seconds}, {"warned", warned}};
}

std::string status_text(const BatchStatus& status, const BatchView& view,
                        std::size_t max_failures) {
    std::string text = fmt::format(
        "{}: {} done, {} failed, {} running, {} waiting ({} of them released); {} tried again\n",
        counted(status.jobs, "job"), status.done, status.failed, status.running.size(),
        status.waiting, status.released, status.retried);
    const std::size_t ended = status.done + status.failed;
    if (ended > 0)
        text += fmt::format("{} per job\n",
                            format_duration(status.seconds / static_cast<double>(ended)));
    for (const RunningJob& job : status.running)
        text += fmt::format("running: {}, attempt {}, {}\n", title_of(view.entry(job.index).job),
                            job.attempt,
                            job.has_ended  ? "its worker has ended, another one will continue"
                            : job.beat > 0 ? fmt::format("{}, heartbeat {}", job.worker, job.beat)
                                           : job.worker + ", no heartbeat");
    for (std::size_t i = 0; i < std::min(max_failures, status.failures.size()); ++i) {
        const BatchEntry& entry = view.entry(status.failures[i]);
        text += fmt::format("failed: {}: {}\n", title_of(entry.job), entry.last.message);
    }
    if (status.failures.size() > max_failures)
        text += fmt::format("... and {} more; --json lists all\n",
                            status.failures.size() - max_failures);
    if (!status.warned.empty())
        text += fmt::format("{} with warnings; see --json or index.html\n",
                            counted(status.warned.size(), "job"));
    return text;
}

}  // namespace item3d
