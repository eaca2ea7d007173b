// A worker of a batch, which claims jobs, runs them, and publishes their results.
#pragma once

#include "item3d/batch/attempt.h"
#include "item3d/batch/batch_folder.h"

#include <chrono>
#include <cstddef>
#include <filesystem>

namespace item3d {

struct WorkerOptions {
    AttemptLimits limits;
    /// Time without a heartbeat after which a worker on another machine counts as dead.
    std::chrono::milliseconds stale_after = std::chrono::seconds(60);
    std::chrono::milliseconds beat_every = std::chrono::seconds(2);
    /// Interval between two reads of the jobs and journals.
    std::chrono::milliseconds look_every = std::chrono::seconds(2);
    double until_seconds = 0;  ///< time until the worker interrupts itself; 0: no limit
    double idle_seconds = -1;  ///< longest wait for a job to claim; < 0: no limit
    std::size_t index = 0;     ///< index of this worker among those started together
};

struct WorkerCounts {
    std::size_t done = 0, failed = 0, released = 0, lost = 0;
};

/// Works until all jobs of the batch are done or failed; some of them may be other workers' jobs.
/// After SIGTERM, Ctrl-C or until_seconds, releases the current job and throws Interrupted. If
/// nothing can be written, releases the current job and throws DiskFull. Throws InputError if only
/// jobs of another version of the program are left.
WorkerCounts run_worker(const BatchFolder& folder, const WorkerOptions& options,
                        const JobRunner& run);

/// Returns the model in a job's result: model.glb, or model.vrm. The path is empty if there is
/// none.
std::filesystem::path model_in(const std::filesystem::path& folder);

}  // namespace item3d
