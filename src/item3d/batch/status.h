// Status of a batch.
#pragma once

#include "item3d/batch/batch_view.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct RunningJob {
    std::size_t index;   ///< in the view
    std::string worker;  ///< "" during the claim
    int attempt = 0;
    std::int64_t beat = 0;   ///< its worker's counter; 0: no heartbeat was found
    bool has_ended = false;  ///< the worker is known to have ended; another will take the job over
};

struct BatchStatus {
    std::size_t jobs = 0, waiting = 0, done = 0, failed = 0;
    std::size_t retried = 0;   ///< jobs begun again after an error or a worker's death
    std::size_t released = 0;  ///< waiting jobs that were begun
    double seconds = 0;        ///< total of the ended attempts
    std::vector<RunningJob> running;
    /// Indices in the view, in job order.
    std::vector<std::size_t> failures, warned;
};

/// Reads the status from the journals, and from the folders of begun jobs without journal lines.
/// Tells the view of finished jobs whose worker was killed before it could write a line.
BatchStatus status_of(const BatchFolder& folder, BatchView& view);

/// Returns {"jobs", "waiting", "running", "done", "failed", ...} with running jobs and failures by
/// name.
nlohmann::json status_json(const BatchStatus& status, const BatchView& view);
/// Returns the content of status_json() as text, with at most `max_failures` failures.
std::string status_text(const BatchStatus& status, const BatchView& view,
                        std::size_t max_failures = 10);

}  // namespace item3d
