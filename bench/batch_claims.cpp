// Benchmark of a batch's overhead with many jobs: the time to claim and publish one job, and to
// report the state of all jobs. The jobs are simulated: each writes a model file of a few bytes.
#include "item3d/batch/batch_view.h"
#include "item3d/batch/gallery.h"
#include "item3d/batch/status.h"
#include "item3d/batch/worker.h"
#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/interrupt.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::vector<BatchJob> many_jobs(int count) {
    std::vector<BatchJob> jobs;
    for (int i = 0; i < count; ++i) {
        BatchJob job;
        job.id = sha256(std::to_string(i)).substr(0, 16);
        job.key = "row " + std::to_string(i);
        job.place = fmt::format("jobs.csv: row {}", i + 1);
        job.command = "edit";
        job.model = fmt::format("/models/product-{:06}.glb", i);
        job.model_hash = sha256(job.model);
        job.from = fmt::format("a product {}", i);
        job.to = fmt::format("a golden product {}", i);
        job.arguments = {"--from", job.from, "--seed", "0", "--to", job.to};
        job.version = version();
        job.folder = job_folder_name(job.id, "product " + job.to);
        jobs.push_back(job);
    }
    return jobs;
}

/// Claims and publishes `jobs` jobs as a worker does, and prints the times.
void work(const BatchFolder& folder, int jobs, std::size_t index) {
    int runs = 0;
    WorkerOptions options;
    options.index = index;
    const auto begin = std::chrono::steady_clock::now();
    auto first = begin;
    try {
        run_worker(folder, options, [&](const ClaimedJob& job) {
            if (runs == 0) first = std::chrono::steady_clock::now();
            if (++runs > jobs) request_interrupt();
            if (runs > jobs) throw Interrupted("enough");
            write_atomically(job.folder / "model.glb", std::string_view("model"));
            return nlohmann::json();
        });
    } catch (const Interrupted&) {
    }
    const double all = seconds_since(first);
    fmt::print("worker {}: {:.2f} s until its first job, then {} jobs, {:.2f} ms each\n", index,
               seconds_since(begin) - all, std::min(runs, jobs),
               1000 * all / std::max(1, std::min(runs, jobs)));
}

void print_status(const BatchFolder& folder) {
    auto begin = std::chrono::steady_clock::now();
    BatchView view(folder);
    const double read = seconds_since(begin);
    const BatchStatus status = status_of(folder, view);
    fmt::print("status: {} jobs, {} done: {:.2f} s (of which {:.2f} s to read jobs and journals)\n",
               status.jobs, status.done, seconds_since(begin), read);
    begin = std::chrono::steady_clock::now();
    view.refresh();
    status_of(folder, view);
    fmt::print("status again, as --watch does: {:.3f} s\n", seconds_since(begin));
    begin = std::chrono::steady_clock::now();
    const std::string page = gallery_html(folder, view);
    fmt::print("gallery: {:.1f} MB in {:.2f} s\n", static_cast<double>(page.size()) / 1e6,
               seconds_since(begin));
}

int run(int argc, char** argv) {
    if (argc != 5) {
        fmt::print(stderr, "usage: batch_claims FOLDER JOBS WORKERS JOBS_OF_EACH\n");
        return 2;
    }
    const int jobs = std::atoi(argv[2]), workers = std::atoi(argv[3]), each = std::atoi(argv[4]);
    set_verbosity(Verbosity::quiet);
    const BatchFolder folder = BatchFolder::create(argv[1]);
    const auto begin = std::chrono::steady_clock::now();
    folder.add_jobs(many_jobs(jobs));
    fmt::print("{} jobs added in {:.2f} s\n", jobs, seconds_since(begin));
    print_status(folder);
    std::fflush(stdout);
    for (int i = 0; i < workers; ++i)
        if (::fork() == 0) {
            work(folder, each, static_cast<std::size_t>(i));
            std::fflush(stdout);
            ::_exit(0);
        }
    while (::wait(nullptr) > 0) {
    }
    print_status(folder);
    return 0;
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    return item3d::run(argc, argv);
}
