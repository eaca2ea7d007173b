// An attempt at a claimed job: the run and its outcome.
#pragma once

#include "item3d/batch/claim.h"
#include "item3d/batch/job.h"
#include "item3d/batch/job_event.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// A claimed job that is ready to run.
struct ClaimedJob {
    const BatchJob& job;
    std::filesystem::path model;   ///< the job's model, or its predecessor's output
    std::filesystem::path folder;  ///< existing output folder
    bool resume = false;           ///< true if `folder` has an earlier checkpoint
};

/// Runs a job and returns `outcome` of its JobEvent. An InputError or UsageError makes the job fail
/// at once. DiskFull and Interrupted release the job and stop the worker. After any other error the
/// job is retried.
using JobRunner = std::function<nlohmann::json(const ClaimedJob&)>;

struct AttemptLimits {
    int retries = 2;     ///< maximum number of retries after a transient error
    int max_deaths = 9;  ///< maximum number of attempts whose worker died
};

struct AttemptEnd {
    JobEvent event;        ///< the event to publish, unless is_lost
    bool is_lost = false;  ///< another worker took the job over; nothing was changed
    enum class Stop { none, interrupted, disk_full } stop = Stop::none;
    std::string reason;  ///< for disk_full
};

/// Returns an event with this attempt's worker and number. It has the counts of earlier attempts,
/// which are stored in the claim's folder.
JobEvent begin_event(const BatchJob& job, const Claim& claim, const std::string& worker);

/// Runs the job, then publishes, fails or releases it. event: from begin_event(); its `deaths` must
/// already count the worker of the last attempt if that worker died.
AttemptEnd run_attempt(const BatchJob& job, const std::filesystem::path& model, const Claim& claim,
                       JobEvent event, const AttemptLimits& limits, const JobRunner& run);

/// Makes the job fail without running it.
AttemptEnd give_up(const Claim& claim, JobEvent event, const std::string& message);

/// Returns the event stored in the folder of a finished job or an attempt. If there is none, `job`
/// of the returned event is empty.
JobEvent read_event(const std::filesystem::path& folder);

}  // namespace item3d
