// Hands a batch's workers to Slurm.
#pragma once

#include "item3d/batch/slurm/slurm_script.h"

#include <string>
#include <vector>

namespace item3d {

/// An array of workers: tasks 0 .. count - 1, which are the workers first .. first + count - 1.
struct WorkerArray {
    int first = 0;
    int count = 0;
};
/// As few arrays as a site takes with at most max_array_size tasks each.
std::vector<WorkerArray> worker_arrays(int workers, int max_array_size);

/// MaxArraySize of what `scontrol show config` prints; 1001, Slurm's default, where it is not
/// there.
int max_array_size_in(const std::string& config);

struct SlurmSubmission {
    std::filesystem::path script;     ///< of the workers
    std::vector<std::string> arrays;  ///< Slurm's job ids
    std::string summary;              ///< that of the summary
};

/// Writes slurm/workers.sh and slurm/summary.sh into the batch's folder and submits them: arrays of
/// `workers` workers, and the summary behind all of them. Throws ResourceError where there is no
/// Slurm, InputError with what sbatch said where it refuses; arrays that it took before are
/// cancelled then.
SlurmSubmission submit_to_slurm(const SlurmJob& job, int workers);

}  // namespace item3d
