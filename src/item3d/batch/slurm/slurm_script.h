// Slurm scripts of a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct SlurmJob {
    std::filesystem::path program;  ///< absolute path of item3d
    std::filesystem::path batch;    ///< absolute path of the batch's folder
    std::string name = "item3d";
    int threads = 0;          ///< threads of each worker; 0: the site's default for a task
    int gpus_per_worker = 0;  ///< 0 or 1; 0: compute on the CPU
    /// Time in seconds between the signal TERM and Slurm's time limit. On TERM a worker writes its
    /// checkpoint.
    int grace_seconds = 90;
    std::vector<std::string> sbatch_options;  ///< options given by the user: "--partition=night"
    /// The arguments that follow the folder in `item3d batch work`.
    std::vector<std::string> worker_arguments;
};

/// Returns the script of the array tasks. Each task is one worker, which claims jobs until none is
/// left or Slurm sends TERM; after TERM the script requeues its own task. The script takes one
/// argument: the index of task 0's worker.
std::string worker_script(const SlurmJob& job);

/// Returns the script that runs after the workers and writes the batch's results.
std::string summary_script(const SlurmJob& job);

/// Returns a word quoted for the shell.
std::string shell_word(const std::string& text);

}  // namespace item3d
