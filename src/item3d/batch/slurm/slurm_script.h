// Slurm scripts of a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct SlurmJob {
    std::filesystem::path program;  ///< item3d, absolute
    std::filesystem::path batch;    ///< the batch's folder, absolute
    std::string name = "item3d";
    int threads = 0;          ///< per worker; 0: the site's default for a task
    int gpus_per_worker = 0;  ///< 0 or 1; 0: compute on the CPU
    /// Time between TERM and the time limit, in seconds. On TERM a worker writes its checkpoint.
    int grace_seconds = 90;
    std::vector<std::string> sbatch_options;  ///< options of the user: "--partition=night"
    /// Arguments of `item3d batch work` that follow the folder.
    std::vector<std::string> worker_arguments;
};

/// Returns the script of the array tasks. Each task is one worker, which claims jobs until none is
/// left or Slurm sends TERM; after TERM the script requeues its own task. Argument of the script:
/// the index of the worker of task 0.
std::string worker_script(const SlurmJob& job);

/// Returns the script that runs after the workers and writes the batch's results.
std::string summary_script(const SlurmJob& job);

/// Returns a word quoted for the shell.
std::string shell_word(const std::string& text);

}  // namespace item3d
