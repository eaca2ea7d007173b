// Submission of a batch's workers to Slurm.
#pragma once

#include "item3d/batch/slurm/slurm_script.h"

#include <string>
#include <vector>

namespace item3d {

/// A job array of workers. Its tasks 0 to count - 1 are the workers `first` to first + count - 1.
struct WorkerArray {
    int first = 0;
    int count = 0;
};
/// Splits the workers into as few arrays as possible with at most max_array_size tasks each.
std::vector<WorkerArray> worker_arrays(int workers, int max_array_size);

/// Returns the value of MaxArraySize in `config`, the output of `scontrol show config`. If the
/// value is missing, returns 1001, which is Slurm's default.
int max_array_size_in(const std::string& config);

struct SlurmSubmission {
    std::filesystem::path script;     ///< the workers' script
    std::vector<std::string> arrays;  ///< Slurm's job ids of the arrays
    std::string summary;              ///< Slurm's job id of the summary
};

/// Writes slurm/workers.sh and slurm/summary.sh into the batch's folder and submits them. The
/// arrays have `workers` workers in total, and the summary starts after all of them. Throws
/// ResourceError if there is no Slurm. If sbatch refuses, cancels the arrays that it accepted
/// before, and throws InputError with sbatch's message.
SlurmSubmission submit_to_slurm(const SlurmJob& job, int workers);

}  // namespace item3d
