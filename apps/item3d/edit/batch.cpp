// Command item3d batch: runs many edits and relightings with several workers.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/batch_jobs.h"
#include "apps/item3d/edit/batch_variants.h"
#include "apps/item3d/edit/commands.h"
#include "item3d/batch/gallery.h"
#include "item3d/batch/plan_jobs.h"
#include "item3d/batch/remove_jobs.h"
#include "item3d/batch/results_table.h"
#include "item3d/batch/retry.h"
#include "item3d/batch/slurm/slurm_submit.h"
#include "item3d/batch/status.h"
#include "item3d/batch/supervisor.h"
#include "item3d/batch/worker.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/program.h"
#include "item3d/core/progress.h"
#include "item3d/core/seeds.h"
#include "item3d/core/version.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct WorkLimits {
    double stale_seconds = 60;
    AttemptLimits attempts;
};

struct BatchCommand : CommonOptions {
    fs::path jobs;
    fs::path output;
    JobMatrix matrix;
    std::vector<std::string> values;  ///< NAME=VALUE
    std::string seeds;
    int workers = 1;
    bool variants = false;
    bool slurm = false;
    std::vector<std::string> sbatch_options;
    int gpus_per_worker = 0;
    WorkLimits limits;
};

struct WorkCommand : CommonOptions {
    fs::path folder;
    WorkLimits limits;
    double until_seconds = 0;
    double idle_seconds = -1;
    std::size_t index = 0;
};

struct StatusCommand : CommonOptions {
    fs::path folder;
    std::vector<std::string> jobs;  ///< for remove
    bool watch = false;
    bool variants = false;
};

void add_limits(CLI::App& command, WorkLimits& limits) {
    command
        .add_option(
            "--stale-seconds", limits.stale_seconds,
            "Time without a heartbeat after which a worker on another machine counts as dead")
        ->check(CLI::Range(0.1, 1e6))
        ->capture_default_str();
    command
        .add_option("--retries", limits.attempts.retries,
                    "Retries after an error that may be temporary, such as a lack of memory")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command
        .add_option("--deaths", limits.attempts.max_deaths, "Worker deaths after which a job fails")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
}

std::vector<std::string> limit_arguments(const WorkLimits& limits) {
    return {"--stale-seconds", fmt::format("{}", limits.stale_seconds),
            "--retries",       std::to_string(limits.attempts.retries),
            "--deaths",        std::to_string(limits.attempts.max_deaths)};
}

std::vector<JobRow> rows_of(const BatchCommand& command) {
    const bool by_options = !command.matrix.models.empty();
    if (command.jobs.empty() && !by_options)
        throw UsageError("a file of jobs is required, or --models, --from and --to");
    if (!command.jobs.empty() &&
        (by_options || !command.matrix.from.empty() || !command.matrix.to.empty()))
        throw UsageError("a file of jobs cannot be combined with --models, --from and --to");
    if (by_options && (command.matrix.from.empty() || command.matrix.to.empty()))
        throw UsageError("--models requires --from and --to");
    std::vector<std::string> values = command.values;
    if (!command.seeds.empty())
        for (const std::uint64_t seed : parse_seeds(command.seeds))
            values.push_back(fmt::format("seed={}", seed));
    if (command.device != "auto") values.push_back("device=" + command.device);
    return with_values(by_options ? matrix_rows(command.matrix) : read_job_rows(command.jobs),
                       values);
}

/// Plans the jobs before anything is written, and adds the new ones.
BatchFolder add_jobs(const fs::path& output, const std::vector<JobRow>& rows) {
    JobPlanning planning{job_commands(), version(), identity_of_prior, check_job, {}};
    if (BatchFolder::is_begun(output)) {
        const BatchView view(BatchFolder::open(output));
        for (const BatchEntry& entry : view.entries())
            if (entry.is_current() && !entry.job.name.empty())
                planning.known_names[entry.job.name] = entry.job.id;
    }
    std::vector<BatchJob> jobs = plan_jobs(rows, planning);
    const BatchFolder folder = BatchFolder::create(output);
    const BatchView view(folder);
    std::vector<BatchJob> added;
    std::size_t known = 0, replaced = 0;
    for (BatchJob& job : jobs) {
        const auto before = view.find_key(job.key);
        if (before && view.entry(*before).job.id == job.id) {
            ++known;
            continue;
        }
        if (before) ++replaced;
        added.push_back(std::move(job));
    }
    folder.add_jobs(added);
    note(fmt::format("{} added{}{}", counted(added.size(), "job"),
                     known > 0 ? fmt::format(", {} already exist", known) : "",
                     replaced > 0 ? fmt::format(", {} replace earlier ones", replaced) : ""));
    return folder;
}

void write_pages(const BatchFolder& folder, const BatchView& view) {
    write_atomically(folder.path() / "results.csv", std::string_view(results_csv(view)));
    write_atomically(folder.path() / "index.html", std::string_view(gallery_html(folder, view)));
}

/// Throws InputError if a job failed.
void conclude(const BatchFolder& folder, bool json) {
    BatchView view(folder);
    const BatchStatus status = status_of(folder, view);
    write_pages(folder, view);
    if (json)
        print_json(status_json(status, view));
    else
        fmt::print("{}\n", (folder.path() / "index.html").string());
    if (status.failed > 0)
        throw InputError(folder.path().string(),
                         fmt::format("{} of {} failed", status.failed, counted(status.jobs, "job")),
                         "index.html lists them first; `item3d batch retry` runs them again");
}

/// Submits the workers as tasks of job arrays. The tasks may still wait in the queue when the
/// function returns.
void submit_batch(const BatchCommand& command, const BatchFolder& folder) {
    SlurmJob job;
    job.program = launcher_program();
    job.batch = fs::absolute(folder.path());
    job.threads = command.threads;
    job.gpus_per_worker = command.gpus_per_worker;
    job.sbatch_options = command.sbatch_options;
    job.worker_arguments = limit_arguments(command.limits);
    if (command.quiet) job.worker_arguments.emplace_back("--quiet");
    const SlurmSubmission submission = submit_to_slurm(job, command.workers);
    if (command.json)
        print_json({{"script", submission.script.string()},
                    {"arrays", submission.arrays},
                    {"summary", submission.summary}});
    else
        fmt::print(
            "{} workers run as Slurm jobs {}, and job {} writes the summary; for the progress: "
            "item3d batch status {}\n",
            command.workers, fmt::join(submission.arrays, ", "), submission.summary,
            shell_word(job.batch.string()));
}

void run_batch(const BatchCommand& command) {
    if (command.output.empty()) throw UsageError("-o is required: a folder for the batch");
    if (!command.slurm && (!command.sbatch_options.empty() || command.gpus_per_worker > 0))
        throw UsageError("--sbatch-option and --gpus-per-worker require --slurm");
    if (command.variants && (command.slurm || command.workers == 0))
        throw UsageError(
            "--variants: not possible when jobs run elsewhere; after they are done, run `item3d "
            "batch report DIR --variants`");
    if (command.slurm && command.workers == 0)
        throw UsageError("--slurm: --workers must be at least 1");
    const BatchFolder folder = add_jobs(command.output, rows_of(command));
    if (command.workers == 0) return;
    if (command.slurm) {
        submit_batch(command, folder);
        return;
    }
    SupervisorOptions options;
    options.command = {launcher_program().string(), "batch", "work", folder.path().string()};
    const std::vector<std::string> limits = limit_arguments(command.limits);
    options.command.insert(options.command.end(), limits.begin(), limits.end());
    if (command.quiet) options.command.emplace_back("--quiet");
    options.workers = command.workers;
    options.threads = command.threads;
    supervise(folder, options);
    if (command.variants) write_batch_variants(folder, BatchView(folder));
    conclude(folder, command.json);
}

void run_work(const WorkCommand& command) {
    const BatchFolder folder = BatchFolder::open(command.folder);
    WorkerOptions options;
    options.limits = command.limits.attempts;
    options.stale_after =
        std::chrono::milliseconds(static_cast<std::int64_t>(1000 * command.limits.stale_seconds));
    options.beat_every = std::min(options.beat_every, options.stale_after / 4);
    options.until_seconds = command.until_seconds;
    options.idle_seconds = command.idle_seconds;
    options.index = command.index;
    JobProcess process(command.quiet);
    const WorkerCounts counts =
        run_worker(folder, options, [&](const ClaimedJob& job) { return process.run(job); });
    if (command.json)
        print_json({{"done", counts.done},
                    {"failed", counts.failed},
                    {"released", counts.released},
                    {"lost", counts.lost}});
    else
        note(fmt::format("{} done, {} failed, {} released, {} lost", counted(counts.done, "job"),
                         counts.failed, counts.released, counts.lost));
}

void run_status(const StatusCommand& command) {
    const BatchFolder folder = BatchFolder::open(command.folder);
    BatchView view(folder);
    for (;;) {
        const BatchStatus status = status_of(folder, view);
        if (command.json) {
            print_json(status_json(status, view));
        } else {
            // A terminal shows only the newest state.
            fmt::print("{}{}", command.watch && ::isatty(STDOUT_FILENO) ? "\033[H\033[2J" : "",
                       status_text(status, view));
            std::fflush(stdout);
        }
        if (!command.watch || view.open_count() == 0 || interrupted()) return;
        for (int tenths = 0; tenths < 20 && !interrupted(); ++tenths)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        view.refresh();
    }
}

void run_report(const StatusCommand& command) {
    const BatchFolder folder = BatchFolder::open(command.folder);
    BatchView view(folder);
    const BatchStatus status = status_of(folder, view);
    write_pages(folder, view);
    if (command.variants) write_batch_variants(folder, view);
    if (command.json)
        print_json(status_json(status, view));
    else
        fmt::print("{}\n", (folder.path() / "index.html").string());
}

void run_retry(const StatusCommand& command) {
    const BatchFolder folder = BatchFolder::open(command.folder);
    const std::size_t count = retry_failed_jobs(folder);
    if (command.json)
        print_json({{"waiting", count}});
    else
        note(fmt::format("{} will be tried again", counted(count, "job")));
}

void run_remove(const StatusCommand& command) {
    const std::size_t count = remove_jobs(BatchFolder::open(command.folder), command.jobs);
    if (command.json)
        print_json({{"removed", count}});
    else
        note(fmt::format("{} removed; their output folders are kept", counted(count, "job")));
}

std::shared_ptr<StatusCommand> add_folder_command(CLI::App& batch, const std::string& name,
                                                  const std::string& description,
                                                  void (*run)(const StatusCommand&)) {
    auto options = std::make_shared<StatusCommand>();
    CLI::App* command = add_command(batch, name, description, *options);
    command->add_option("DIR", options->folder, "Folder of the batch")->required();
    if (name == "report")
        command->add_flag("--variants", options->variants,
                          "At the end, write variants/MODEL.glb for each model, with its edits as "
                          "variants (KHR_materials_variants)");
    if (name == "remove")
        command
            ->add_option("JOB", options->jobs,
                         "Name, folder or place (\"jobs.csv: row 3\") of a job, as in the status "
                         "and in results.csv")
            ->required();
    if (name == "status")
        command->add_flag("--watch", options->watch,
                          "Print the status every two seconds until all jobs are done or failed");
    command->callback([options, run] {
        start_command(*options);
        run(*options);
    });
    return options;
}

void add_work_command(CLI::App& batch) {
    auto options = std::make_shared<WorkCommand>();
    CLI::App* command =
        add_command(batch, "work",
                    "Run one worker of a batch, on any machine that shares its folder", *options);
    command->add_option("DIR", options->folder, "Folder of the batch")->required();
    add_limits(*command, options->limits);
    command
        ->add_option("--until-seconds", options->until_seconds,
                     "Time after which the worker writes a checkpoint, releases its job and ends")
        ->check(CLI::Range(0.0, 1e9));
    command
        ->add_option("--idle-seconds", options->idle_seconds,
                     "Time without a job to claim after which the worker ends. Default: it waits "
                     "while other workers run, in case one of them dies")
        ->check(CLI::Range(0.0, 1e9));
    command->add_option(
        "--index", options->index,
        "Index of this worker among several; workers start with jobs of different priors");
    command->callback([options] {
        start_command(*options);
        run_work(*options);
    });
}

}  // namespace

void add_batch_command(CLI::App& app) {
    auto options = std::make_shared<BatchCommand>();
    CLI::App* command = add_command(app, "batch", *options);
    command->add_option("JOBS", options->jobs,
                        "Jobs as CSV or JSON Lines: model, from, to, name, after, command (edit or "
                        "relight), and any option of that command");
    command
        ->add_option("-o,--output", options->output,
                     "Folder of the batch; new jobs are added to an existing batch")
        ->type_name("FOLDER");
    const auto each = [](CLI::Option* option) { option->allow_extra_args(false); };
    command
        ->add_option("--models", options->matrix.models,
                     "Models instead of JOBS: files, or a quoted pattern ('shop/*.glb')")
        ->type_name("FILE");
    each(command->add_option("--from", options->matrix.from,
                             "Sentence that describes the models as they are; {name} stands for "
                             "the file's name. Given once, or as often as --to"));
    each(command->add_option("--to", options->matrix.to,
                             "Sentence that describes the models as they should be"));
    command
        ->add_option("--seeds", options->seeds, "Seeds of each job: 0..2, or numbers with commas")
        ->type_name("SEEDS");
    command->add_flag("--variants", options->variants,
                      "At the end, write variants/MODEL.glb for each model, with its edits as "
                      "variants (KHR_materials_variants)");
    each(command
             ->add_option("--with", options->values,
                          "Option for all jobs, such as iterations=100; if a name is given several "
                          "times, each job runs with each value")
             ->type_name("NAME=VALUE"));
    command
        ->add_option("--workers", options->workers,
                     "Worker processes on this machine, which share its cores, as far as memory "
                     "allows; 0: only add the jobs, for `item3d batch work` elsewhere")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command->add_flag(
        "--slurm", options->slurm,
        "Submit --workers workers of --threads CPUs to Slurm as an array (sbatch), and return");
    each(command
             ->add_option("--sbatch-option", options->sbatch_options,
                          "Option of sbatch for --slurm: --sbatch-option=--time=2:00:00")
             ->type_name("OPTION"));
    command
        ->add_option("--gpus-per-worker", options->gpus_per_worker,
                     "GPUs of each worker that --slurm starts")
        ->check(CLI::Range(0, 1))
        ->capture_default_str();
    add_limits(*command, options->limits);
    add_work_command(*command);
    add_folder_command(*command, "status", "Show the progress of a batch", run_status);
    add_folder_command(*command, "report", "Write index.html and results.csv of a batch",
                       run_report);
    add_folder_command(*command, "retry", "Queue failed jobs again", run_retry);
    add_folder_command(*command, "remove", "Remove jobs from a batch", run_remove);
    command->callback([command, options] {
        if (!command->get_subcommands().empty()) return;
        start_command(*options);
        run_batch(*options);
    });
}

}  // namespace item3d
