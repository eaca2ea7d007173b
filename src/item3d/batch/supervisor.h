// Local workers of a batch: started, watched, started again.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct SupervisorOptions {
    /// Program and arguments of one worker; --index and --threads are added.
    std::vector<std::string> command;
    int workers = 1;
    int threads = 0;  ///< of each worker; 0: the cores that this process may use, shared out
};

/// Runs workers until all jobs are done or failed. A worker beyond the first begins only where as
/// much memory is free as the largest has taken so far; one that dies is started again, and its job
/// is taken over. Progress goes to stderr, what workers say to workers/log-N.txt. Throws
/// Interrupted once all workers have kept what they had, DiskFull where they stopped for want of
/// space, and ResourceError where workers die one after another without ending a job.
void supervise(const BatchFolder& folder, const SupervisorOptions& options);

/// Cores that this process may use.
int usable_cores();

}  // namespace item3d
