// The supervisor of a batch's workers on this machine: it starts, watches and restarts them.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct SupervisorOptions {
    /// Program and arguments of one worker, to which --index and --threads are added.
    std::vector<std::string> command;
    int workers = 1;
    int threads = 0;  ///< threads of each worker; 0: the usable cores, divided among the workers
};

/// Runs workers until all jobs are done or failed. A worker beyond the first starts only if the
/// free memory is at least the largest memory that a job has used so far. A worker that dies is
/// restarted, and its job is taken over. Progress goes to stderr; the workers' output goes to
/// workers/log-N.txt. Throws Interrupted after all workers have saved their state, DiskFull if they
/// stopped for lack of space, and ResourceError if workers die repeatedly without finishing a job.
void supervise(const BatchFolder& folder, const SupervisorOptions& options);

/// Returns the number of cores that this process may use.
int usable_cores();

}  // namespace item3d
