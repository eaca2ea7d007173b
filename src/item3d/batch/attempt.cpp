#include "item3d/batch/attempt.h"

#include "item3d/core/disk_full.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"

#include <algorithm>
#include <chrono>
#include <system_error>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Stop = AttemptEnd::Stop;

constexpr const char* checkpoint_name = "checkpoint.safetensors";
constexpr const char* plan_state_name = "plan_state.json";
constexpr const char* event_name = "job.json";

std::string one_line(const std::string& text) {
    constexpr std::size_t longest = 1000;
    return text.substr(0, std::min(text.find('\n'), longest));
}

bool says_disk_full(const std::exception& error) {
    if (dynamic_cast<const DiskFull*>(&error)) return true;
    const auto* system = dynamic_cast<const fs::filesystem_error*>(&error);
    return system && system->code() == std::errc::no_space_on_device;
}

void write_event(const Claim& claim, const JobEvent& event) {
    write_atomically(
        claim.folder() / event_name,
        std::string_view(json(event).dump(2, ' ', false, json::error_handler_t::replace) + "\n"));
}

AttemptEnd publish(const Claim& claim, JobEvent event, JobState state) {
    event.state = state;
    write_event(claim, event);
    std::error_code ignored;
    fs::remove(claim.folder() / checkpoint_name, ignored);  // it is as large as all other files
    const bool is_published =
        claim.publish(state == JobState::done ? FolderState::done : FolderState::failed);
    return {std::move(event), !is_published, Stop::none, ""};
}

AttemptEnd release(const Claim& claim, JobEvent event, Stop stop, const std::string& reason) {
    try {
        write_event(claim, event);
    } catch (const Error&) {
        // If the disk is full, the stored counts stay those of the earlier attempts.
    }
    const bool is_released = claim.release();
    return {std::move(event), !is_released, stop, reason};
}

void keep_warnings(JobEvent& event, const std::vector<std::string>& lines) {
    constexpr std::size_t maximum = 20;
    auto& kept = event.warnings;
    for (const std::string& line : lines) {
        const std::string text = one_line(line);
        if (kept.size() < maximum && std::find(kept.begin(), kept.end(), text) == kept.end())
            kept.push_back(text);
    }
}

json run_or_begin_anew(const ClaimedJob& job, const Claim& claim, const JobRunner& run) {
    try {
        return run(job);
    } catch (const InputError&) {
        // The checkpoint may be the cause of the error.
        if (!job.resume || !claim.is_held()) throw;
    }
    warn(title_of(job.job) + ": cannot resume from its checkpoint and starts from the beginning");
    fs::remove(job.folder / checkpoint_name);
    fs::remove(job.folder / plan_state_name);
    return run({job.job, job.model, job.folder, false});
}

AttemptEnd after_error(const Claim& claim, JobEvent event, const std::exception& error,
                       const AttemptLimits& limits) {
    if (!claim.is_held()) return {std::move(event), true, Stop::none, ""};
    if (says_disk_full(error))
        return release(claim, std::move(event), Stop::disk_full, message_of(error));
    if (dynamic_cast<const Interrupted*>(&error))
        return release(claim, std::move(event), Stop::interrupted, "");
    ++event.errors;
    event.message = one_line(message_of(error));
    const bool is_final = dynamic_cast<const InputError*>(&error) ||
                          dynamic_cast<const UsageError*>(&error) || event.errors > limits.retries;
    return is_final ? publish(claim, std::move(event), JobState::failed)
                    : release(claim, std::move(event), Stop::none, "");
}

}  // namespace

JobEvent read_event(const fs::path& folder) {
    std::error_code code;
    if (!fs::exists(folder / event_name, code)) return {};
    const json value = parse_json(read_text(folder / event_name));
    try {
        return value.get<JobEvent>();
    } catch (const json::exception&) {
        return {};
    }
}

JobEvent begin_event(const BatchJob& job, const Claim& claim, const std::string& worker) {
    JobEvent event = read_event(claim.folder());
    if (event.state == JobState::failed) {  // a failed job that is retried
        event.errors = event.deaths = 0;
        event.warnings.clear();
    }
    event.job = job.id;
    event.state = JobState::waiting;
    event.worker = worker;
    event.attempt = claim.attempt();
    event.message.clear();
    event.outcome = nullptr;
    return event;
}

AttemptEnd run_attempt(const BatchJob& job, const fs::path& model, const Claim& claim,
                       JobEvent event, const AttemptLimits& limits, const JobRunner& run) {
    const auto begin = std::chrono::steady_clock::now();
    const CollectedWarnings warnings;
    const auto take_stock = [&] {
        event.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        keep_warnings(event, warnings.lines());
    };
    try {
        if (claim.attempt() > 1) write_event(claim, event);  // stores the number of deaths
        if (event.deaths > limits.max_deaths)
            return give_up(
                claim, std::move(event),
                fmt::format(
                    "its worker died {} times while running it, possibly from a lack of memory",
                    event.deaths));
        // A plan has no checkpoint between two of its edits, only its plan state.
        const bool resume = fs::exists(claim.folder() / checkpoint_name) ||
                            fs::exists(claim.folder() / plan_state_name);
        note(fmt::format("{}: {}{}", title_of(job), job.folder,
                         resume ? ", from its checkpoint" : ""));
        event.outcome = run_or_begin_anew({job, model, claim.folder(), resume}, claim, run);
        take_stock();
        return publish(claim, event, JobState::done);
    } catch (const std::exception& error) {
        take_stock();
        event.outcome = nullptr;
        return after_error(claim, std::move(event), error, limits);
    }
}

AttemptEnd give_up(const Claim& claim, JobEvent event, const std::string& message) {
    event.message = message;
    return publish(claim, std::move(event), JobState::failed);
}

}  // namespace item3d
