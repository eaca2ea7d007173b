// Status of a batch.
#pragma once

#include "item3d/batch/batch_view.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct RunningJob {
    std::size_t index;   ///< index of the job in the view
    std::string worker;  ///< "" while the job is being claimed
    int attempt = 0;
    std::int64_t beat = 0;   ///< counter of the worker's heartbeat; 0 if there is no heartbeat
    bool has_ended = false;  ///< the worker is known to have ended; another will take the job over
};

struct BatchStatus {
    std::size_t jobs = 0, waiting = 0, done = 0, failed = 0;
    std::size_t retried = 0;   ///< jobs begun again after an error or a worker's death
    std::size_t released = 0;  ///< waiting jobs that a worker began and released
    double seconds = 0;        ///< total duration of the ended attempts
    std::vector<RunningJob> running;
    /// Indices in the view, in its order, of failed jobs and of jobs with warnings.
    std::vector<std::size_t> failures, warned;
};

/// Returns the status. It is read from the journals and, for begun jobs without journal lines, from
/// their folders. Some jobs are finished, but their worker was killed before it wrote a journal
/// line; the function marks these as finished in the view.
BatchStatus status_of(const BatchFolder& folder, BatchView& view);

/// Returns {"jobs", "waiting", "running", "done", "failed", ...}. Running and failed jobs are
/// listed by name.
nlohmann::json status_json(const BatchStatus& status, const BatchView& view);
/// Returns the content of status_json() as text, with at most `max_failures` failures.
std::string status_text(const BatchStatus& status, const BatchView& view,
                        std::size_t max_failures = 10);

}  // namespace item3d
