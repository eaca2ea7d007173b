// Submission of a batch's workers to Slurm.
#pragma once

#include "item3d/batch/slurm/slurm_script.h"

#include <string>
#include <vector>

namespace item3d {

/// Array of workers: tasks 0 .. count - 1 are the workers first .. first + count - 1.
struct WorkerArray {
    int first = 0;
    int count = 0;
};
/// Splits the workers into as few arrays as possible with at most max_array_size tasks each.
std::vector<WorkerArray> worker_arrays(int workers, int max_array_size);

/// Returns MaxArraySize in the output of `scontrol show config`; 1001, Slurm's default, if it is
/// missing.
int max_array_size_in(const std::string& config);

struct SlurmSubmission {
    std::filesystem::path script;     ///< the workers' script
    std::vector<std::string> arrays;  ///< Slurm job ids
    std::string summary;              ///< Slurm job id of the summary
};

/// Writes slurm/workers.sh and slurm/summary.sh into the batch's folder and submits them: arrays of
/// `workers` workers, and the summary, which starts after all of them. Throws ResourceError if
/// there is no Slurm, and InputError with sbatch's message if sbatch refuses; the arrays accepted
/// before are then cancelled.
SlurmSubmission submit_to_slurm(const SlurmJob& job, int workers);

}  // namespace item3d
