// One attempt at a claimed job: its run and its outcome.
#pragma once

#include "item3d/batch/claim.h"
#include "item3d/batch/job.h"
#include "item3d/batch/job_event.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// Claimed job, ready to run.
struct ClaimedJob {
    const BatchJob& job;
    std::filesystem::path model;   ///< the job's, or the output of its predecessor
    std::filesystem::path folder;  ///< existing output folder
    bool resume = false;           ///< true if another attempt left a checkpoint there
};

/// Runs a job and returns the "outcome" of its event. An InputError or UsageError fails the job at
/// once, DiskFull and Interrupted release it and stop the worker, other errors are retried.
using JobRunner = std::function<nlohmann::json(const ClaimedJob&)>;

struct AttemptLimits {
    int retries = 2;     ///< maximum number of retries after a transient error
    int max_deaths = 9;  ///< number of attempts with a dead worker after which a job fails
};

struct AttemptEnd {
    JobEvent event;        ///< event to be published, unless is_lost
    bool is_lost = false;  ///< another worker took the job over; nothing was changed
    enum class Stop { none, interrupted, disk_full } stop = Stop::none;
    std::string reason;  ///< for disk_full
};

/// Returns an event with the counts of earlier attempts, stored in the claim's folder, and this
/// attempt's worker and number.
JobEvent begin_event(const BatchJob& job, const Claim& claim, const std::string& worker);

/// Runs the job, then publishes, fails or releases it. event: from begin_event(), with `deaths`
/// counted.
AttemptEnd run_attempt(const BatchJob& job, const std::filesystem::path& model, const Claim& claim,
                       JobEvent event, const AttemptLimits& limits, const JobRunner& run);

/// Fails the job without a run.
AttemptEnd give_up(const Claim& claim, JobEvent event, const std::string& message);

/// Reads the event in the folder of a finished job or an attempt; an event with an empty `job` if
/// there is none.
JobEvent read_event(const std::filesystem::path& folder);

}  // namespace item3d
