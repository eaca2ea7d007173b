#include "item3d/batch/slurm/slurm_script.h"

#include "item3d/core/format.h"

namespace item3d {
namespace {

/// Returns "#SBATCH OPTION" lines, so that the script documents its request. The user's options
/// come last, because later options take priority.
std::string directives(const SlurmJob& job, const std::vector<std::string>& own) {
    std::string lines;
    for (const auto* options : {&own, &job.sbatch_options})
        for (const std::string& option : *options)
            lines += "#SBATCH " + option + "\n";
    return lines;
}

}  // namespace

std::string shell_word(const std::string& text) {
    const bool is_plain =
        !text.empty() && text.find_first_not_of(
                             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                             "0123456789_@%+=:,./-") == std::string::npos;
    if (is_plain) return text;
    std::string word = "'";
    for (const char character : text)
        word += character == '\'' ? std::string("'\\''") : std::string(1, character);
    return word + "'";
}

std::string worker_script(const SlurmJob& job) {
    std::vector<std::string> own = {"--job-name=" + job.name,
                                    "--nodes=1",
                                    "--ntasks=1",
                                    "--requeue",
                                    "--open-mode=append",
                                    "--output=" + (job.batch / "slurm" / "%A_%a.log").string(),
                                    fmt::format("--signal=B:TERM@{}", job.grace_seconds)};
    if (job.threads > 0) own.push_back(fmt::format("--cpus-per-task={}", job.threads));
    if (job.gpus_per_worker > 0)
        own.push_back(fmt::format("--gpus-per-task={}", job.gpus_per_worker));
    std::string arguments;
    for (const std::string& argument : job.worker_arguments)
        arguments += " " + shell_word(argument);
    return "#!/bin/bash\n" + directives(job, own) +
           fmt::format(R"(
# One array task is one worker, which claims jobs of the batch until none is left. Before its time
# limit, and on preemption, Slurm sends TERM to this script; the worker then writes its
# checkpoint, releases its job and ends with 130, and this array task is requeued.
worker=
trap '[ -z "$worker" ] || kill -TERM "$worker" 2>/dev/null' TERM
task=${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID
echo "task $task, start $((${{SLURM_RESTART_COUNT:-0}} + 1)), on $SLURMD_NODENAME"

{program} batch work {batch}{arguments} \
    --index $((${{1:-0}} + SLURM_ARRAY_TASK_ID)) \
    --threads "${{SLURM_CPUS_PER_TASK:-${{SLURM_CPUS_ON_NODE:-1}}}}" &
worker=$!
wait "$worker"
code=$?
# A trap ends the wait, not the worker.
while kill -0 "$worker" 2>/dev/null; do
    wait "$worker"
    code=$?
done
# 128 and more: the worker was killed, and this task is requeued. Cancelled jobs are sent TERM as
# well; they are not requeued.
if [ "$code" -ge 128 ] && scontrol show job "$SLURM_JOB_ID" | grep -q JobState=RUNNING; then
    scontrol requeue "$task"
    sleep 30  # until Slurm ends this run
fi
exit "$code"
)",
                       fmt::arg("program", shell_word(job.program.string())),
                       fmt::arg("batch", shell_word(job.batch.string())),
                       fmt::arg("arguments", arguments));
}

std::string summary_script(const SlurmJob& job) {
    const std::vector<std::string> own = {
        "--job-name=" + job.name + "-summary", "--nodes=1", "--ntasks=1",
        "--output=" + (job.batch / "slurm" / "summary.log").string()};
    return "#!/bin/bash\n" + directives(job, own) +
           fmt::format(
               "\n# When the last worker has ended: index.html, results.csv and the state of the "
               "jobs.\n{0} batch report {1}\n{0} batch status {1}\n",
               shell_word(job.program.string()), shell_word(job.batch.string()));
}

}  // namespace item3d
