// The scripts that Slurm runs for a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct SlurmJob {
    std::filesystem::path program;  ///< item3d, absolute
    std::filesystem::path batch;    ///< the batch's folder, absolute
    std::string name = "item3d";
    int threads = 0;          ///< of a worker; 0: as many as the site gives a task
    int gpus_per_worker = 0;  ///< 0 or 1; 0: it computes on the CPU
    /// Before the end of its time a worker is told so that it writes its checkpoint.
    int grace_seconds = 90;
    std::vector<std::string> sbatch_options;    ///< of the user: "--partition=night"
    std::vector<std::string> worker_arguments;  ///< of `item3d batch work`, behind the folder
};

/// One array task of this script is one worker: it claims jobs until none is left or Slurm sends
/// TERM, and then has this array task alone queued again. Its one argument is the number of the
/// worker of task 0.
std::string worker_script(const SlurmJob& job);

/// Runs after the workers: writes what became of the jobs.
std::string summary_script(const SlurmJob& job);

/// A word as a shell reads it back.
std::string shell_word(const std::string& text);

}  // namespace item3d
