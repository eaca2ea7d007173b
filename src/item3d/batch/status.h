// How far a batch is.
#pragma once

#include "item3d/batch/batch_view.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct RunningJob {
    std::size_t index;   ///< in the view
    std::string worker;  ///< "" while it is being claimed
    int attempt = 0;
    std::int64_t beat = 0;   ///< of its worker; 0: no sign of life was found
    bool has_ended = false;  ///< the worker is known to have ended: another will take the job over
};

struct BatchStatus {
    std::size_t jobs = 0, waiting = 0, done = 0, failed = 0;
    std::size_t retried = 0;   ///< jobs begun again after an error or the death of a worker
    std::size_t released = 0;  ///< of the waiting, those that were begun
    double seconds = 0;        ///< of the attempts that ended, together
    std::vector<RunningJob> running;
    /// Indices in the view, in the order of jobs.
    std::vector<std::size_t> failures, warned;
};

/// Looks at what the journals tell, and into the folders of jobs that were begun and of which they
/// do not tell. Tells the view of jobs whose worker was killed before it could write that they are
/// done.
BatchStatus status_of(const BatchFolder& folder, BatchView& view);

/// {"jobs", "waiting", "running", "done", "failed", ...} with running jobs and failures by name.
nlohmann::json status_json(const BatchStatus& status, const BatchView& view);
/// The same in lines for people, of at most `max_failures` failures.
std::string status_text(const BatchStatus& status, const BatchView& view,
                        std::size_t max_failures = 10);

}  // namespace item3d
