// A worker: claims jobs of a batch, runs them, and publishes what they leave.
#pragma once

#include "item3d/batch/attempt.h"
#include "item3d/batch/batch_folder.h"

#include <chrono>
#include <cstddef>
#include <filesystem>

namespace item3d {

struct WorkerOptions {
    AttemptLimits limits;
    /// Without a heartbeat for so long a worker on another machine is taken for dead.
    std::chrono::milliseconds stale_after = std::chrono::seconds(60);
    std::chrono::milliseconds beat_every = std::chrono::seconds(2);
    /// How often jobs and journals are looked at for what is new.
    std::chrono::milliseconds look_every = std::chrono::seconds(2);
    double until_seconds = 0;  ///< stop as an interrupt would after so long; 0: at the end
    double idle_seconds = -1;  ///< end after so long without a job to claim; < 0: wait
    std::size_t index = 0;     ///< of this worker, where it was started as one of several
};

struct WorkerCounts {
    std::size_t done = 0, failed = 0, released = 0, lost = 0;
};

/// Works until all jobs of the batch are done or failed, also by others. Throws Interrupted after
/// SIGTERM, Ctrl-C or until_seconds, with the job in hand released; DiskFull where no more can be
/// written, likewise; InputError where only jobs of another version of the program are left.
WorkerCounts run_worker(const BatchFolder& folder, const WorkerOptions& options,
                        const JobRunner& run);

/// The model that a job leaves in its result: model.glb, or model.vrm. Empty: there is none.
std::filesystem::path model_in(const std::filesystem::path& folder);

}  // namespace item3d
