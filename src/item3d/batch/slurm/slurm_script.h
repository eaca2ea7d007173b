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
    int threads = 0;          ///< per worker; 0: as many as the site gives a task
    int gpus_per_worker = 0;  ///< 0 or 1; 0: compute on the CPU
    /// Seconds before the time limit at which a worker is told to write its checkpoint.
    int grace_seconds = 90;
    std::vector<std::string> sbatch_options;  ///< the user's: "--partition=night"
    /// Arguments of `item3d batch work`, after the folder.
    std::vector<std::string> worker_arguments;
};

/// Returns the script of which one array task is one worker: it claims jobs until none is left or
/// Slurm sends TERM, and then requeues this array task alone. Its argument is the number of the
/// worker of task 0.
std::string worker_script(const SlurmJob& job);

/// Returns the script that runs after the workers and writes the batch's results.
std::string summary_script(const SlurmJob& job);

/// Quotes a word for the shell.
std::string shell_word(const std::string& text);

}  // namespace item3d
