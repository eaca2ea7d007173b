// One attempt at a claimed job: the run, and what its end means.
#pragma once

#include "item3d/batch/claim.h"
#include "item3d/batch/job.h"
#include "item3d/batch/job_event.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// A job that was claimed.
struct ClaimedJob {
    const BatchJob& job;
    std::filesystem::path model;   ///< of the job, or what the job before it left
    std::filesystem::path folder;  ///< where everything goes; there already
    bool resume = false;           ///< another attempt left a checkpoint there
};

/// Runs a job and returns what its event shall say of it. An InputError or UsageError fails the job
/// at once, DiskFull and Interrupted release it and stop the worker, anything else is tried again.
using JobRunner = std::function<nlohmann::json(const ClaimedJob&)>;

struct AttemptLimits {
    int retries = 2;     ///< further attempts after an error that may pass
    int max_deaths = 9;  ///< attempts whose worker died, after which a job is given up
};

struct AttemptEnd {
    JobEvent event;        ///< to be told to others, unless is_lost
    bool is_lost = false;  ///< another took the job over: nothing was changed
    enum class Stop { none, interrupted, disk_full } stop = Stop::none;
    std::string reason;  ///< of disk_full
};

/// The counts of earlier attempts, which lie in the folder that is handed on, with this attempt's
/// worker and number.
JobEvent begin_event(const BatchJob& job, const Claim& claim, const std::string& worker);

/// Runs the job and publishes it, or gives it up, or releases it. event: as begin_event(), with
/// `deaths` counted.
AttemptEnd run_attempt(const BatchJob& job, const std::filesystem::path& model, const Claim& claim,
                       JobEvent event, const AttemptLimits& limits, const JobRunner& run);

/// Gives the job up without a run.
AttemptEnd give_up(const Claim& claim, JobEvent event, const std::string& message);

/// The event that lies in the folder of a finished job or an attempt; of no job where there is
/// none.
JobEvent read_event(const std::filesystem::path& folder);

}  // namespace item3d
