#include "item3d/batch/slurm/slurm_submit.h"

#include "item3d/core/child_program.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"

#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr int default_max_array_size = 1001;
constexpr auto poll_every = std::chrono::milliseconds(20);

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\n\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

struct Said {
    bool well = false;
    std::string text;  ///< stdout and stderr
};

/// Runs one of Slurm's programs to its end.
Said run_slurm(const SlurmJob& job, std::vector<std::string> command) {
    const fs::path program = program_in_path(command[0]);
    if (program.empty())
        throw ResourceError("--slurm: " + command[0] +
                            " is not in $PATH; run this on a machine with Slurm's programs, or "
                            "leave out --slurm to work on this machine");
    command[0] = program.string();
    const fs::path output = job.batch / "slurm" / "said.txt";
    fs::remove(output);
    ChildProgram child(command, output);
    std::optional<int> status;
    while (!(status = child.status()))
        std::this_thread::sleep_for(poll_every);
    const Said said{WIFEXITED(*status) && WEXITSTATUS(*status) == 0, trimmed(read_text(output))};
    fs::remove(output);
    return said;
}

/// Submits a script and returns its job id. With --parsable sbatch prints "ID" or "ID;CLUSTER",
/// after any warnings.
std::string submit(const SlurmJob& job, std::vector<std::string> command) {
    command.insert(command.begin(), {"sbatch", "--parsable"});
    const Said said = run_slurm(job, command);
    const std::string last = said.text.substr(said.text.rfind('\n') + 1);
    const std::string id = last.substr(0, last.find(';'));
    if (!said.well || id.empty() || id.find_first_not_of("0123456789") != std::string::npos) {
        std::string line = said.text;
        std::replace(line.begin(), line.end(), '\n', ' ');
        throw InputError("--slurm", "sbatch failed: " + line, "check --sbatch-option");
    }
    return id;
}

}  // namespace

std::vector<WorkerArray> worker_arrays(int workers, int max_array_size) {
    std::vector<WorkerArray> arrays;
    for (int first = 0; first < workers; first += max_array_size)
        arrays.push_back({first, std::min(max_array_size, workers - first)});
    return arrays;
}

int max_array_size_in(const std::string& config) {
    const std::size_t found = config.find("MaxArraySize");
    if (found == std::string::npos) return default_max_array_size;
    const std::size_t digit = config.find_first_of("0123456789\n", found);
    int value = 0;
    if (digit == std::string::npos) return default_max_array_size;
    std::from_chars(config.data() + digit, config.data() + config.size(), value);
    // Slurm reports 0 if arrays are disabled; sbatch then reports the error.
    return value > 0 ? value : default_max_array_size;
}

SlurmSubmission submit_to_slurm(const SlurmJob& job, int workers) {
    const fs::path folder = job.batch / "slurm";
    make_output_folder(folder);
    SlurmSubmission submission;
    submission.script = folder / "workers.sh";
    write_atomically(submission.script, std::string_view(worker_script(job)));
    write_atomically(folder / "summary.sh", std::string_view(summary_script(job)));
    const int largest = max_array_size_in(run_slurm(job, {"scontrol", "show", "config"}).text);
    try {
        std::string all;
        for (const WorkerArray& array : worker_arrays(workers, largest)) {
            submission.arrays.push_back(
                submit(job, {fmt::format("--array=0-{}", array.count - 1),
                             submission.script.string(), std::to_string(array.first)}));
            all += ":" + submission.arrays.back();
        }
        submission.summary =
            submit(job, {"--dependency=afterany" + all, (folder / "summary.sh").string()});
    } catch (const Error&) {
        for (const std::string& id : submission.arrays)
            run_slurm(job, {"scancel", id});
        throw;
    }
    return submission;
}

}  // namespace item3d
