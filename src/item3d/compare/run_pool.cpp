#include "item3d/compare/run_pool.h"

#include "item3d/core/available_memory.h"
#include "item3d/core/child_program.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"

#include <algorithm>
#include <chrono>
#include <list>
#include <memory>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr const char* checkpoint_name = "checkpoint.safetensors";
constexpr double first_guess_bytes = 2e9;
constexpr auto growing_time = std::chrono::seconds(30);
constexpr auto nap = std::chrono::milliseconds(100);
constexpr auto longest_farewell = std::chrono::seconds(60);

struct RunningEdit {
    const CompareRun* run;
    std::unique_ptr<ChildProgram> program;
    Clock::time_point begin = Clock::now();
};

RunningEdit start(const CompareRun& run, const CompareOptions& options) {
    make_output_folder(run.folder);
    fs::remove(run.folder / "failed.txt");
    // A checkpoint means that a run with the same settings was interrupted.
    const bool begun = fs::exists(run.folder / checkpoint_name);
    if (begun) write_atomically(run.folder / resumed_name, std::string_view());
    fs::remove(run.folder / "log.txt");
    std::vector<std::string> arguments = {options.program.string()};
    arguments.insert(arguments.end(), run.arguments.begin(), run.arguments.end());
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int threads =
        options.threads > 0 ? options.threads : std::max(1, cores / options.workers);
    arguments.insert(arguments.end(), {"--threads", std::to_string(threads)});
    if (begun) arguments.emplace_back("--resume");
    return {&run, std::make_unique<ChildProgram>(arguments, run.folder / "log.txt")};
}

/// Returns the peak memory of a run in bytes; 0 if unknown.
double peak_of(const CompareRun& run) {
    const fs::path file = run.folder / "edit.json";
    if (!fs::exists(file)) return 0;
    const Json summary = parse_json(read_text(file));
    return summary.is_object() ? summary.value("peak_memory_bytes", 0.0) : 0;
}

void end_all(std::list<RunningEdit>& running) {
    for (RunningEdit& edit : running)
        edit.program->ask_to_end();
    const auto last = Clock::now() + longest_farewell;
    for (RunningEdit& edit : running)
        while (!edit.program->status() && Clock::now() < last)
            std::this_thread::sleep_for(nap);
    running.clear();
}

}  // namespace

void perform_runs(const std::vector<CompareRun>& runs, const CompareOptions& options) {
    std::list<const CompareRun*> waiting;
    for (const CompareRun& run : runs)
        if (!is_done(run)) waiting.push_back(&run);
    const std::size_t before = runs.size() - waiting.size();
    if (before > 0) note(fmt::format("{} of {} runs already exist", before, runs.size()));
    std::list<RunningEdit> running;
    std::size_t ended = before, started = before;
    const auto beginning = Clock::now();
    double largest = first_guess_bytes;
    const auto may_begin = [&] {
        if (waiting.empty() || running.size() >= static_cast<std::size_t>(options.workers))
            return false;
        // Recently started edits have not allocated all of their memory yet.
        const auto young = std::count_if(running.begin(), running.end(), [](const auto& edit) {
            return Clock::now() - edit.begin < growing_time;
        });
        return running.empty() || available_memory() > largest * static_cast<double>(1 + young);
    };
    // The estimate comes from finished runs; runs of other methods may take longer.
    const auto time_left = [&](std::size_t done) {
        if (done == 0) return std::string();
        const std::chrono::duration<double> spent = Clock::now() - beginning;
        const auto left = static_cast<double>(runs.size() - before - done);
        return fmt::format(", about {} left",
                           format_duration(spent.count() / static_cast<double>(done) * left));
    };
    while (!waiting.empty() || !running.empty()) {
        if (interrupted()) {
            end_all(running);
            throw Interrupted(
                fmt::format("{} of {} runs have ended; run the same command again to continue, or "
                            "with --table-only for the table of these",
                            ended, runs.size()));
        }
        if (may_begin()) {
            note(fmt::format("running {} ({} of {}){}", waiting.front()->folder.filename().string(),
                             ++started, runs.size(), time_left(ended - before)));
            running.push_back(start(*waiting.front(), options));
            waiting.pop_front();
        }
        for (auto edit = running.begin(); edit != running.end();) {
            const auto status = edit->program->status();
            if (!status) {
                ++edit;
                continue;
            }
            const CompareRun& run = *edit->run;
            const std::chrono::duration<double> took = Clock::now() - edit->begin;
            const bool well = *status == 0 && fs::exists(run.folder / "edit.json");
            if (!well && !interrupted())
                write_atomically(run.folder / "failed.txt",
                                 reason_of_end(run.folder / "log.txt", *status));
            if (well) fs::remove(run.folder / checkpoint_name);  // as large as all other files
            largest = std::max(ended == before ? 0.0 : largest, std::max(peak_of(run), 1.0));
            note(fmt::format("{} of {}: {}: {}", ++ended, runs.size(),
                             run.folder.filename().string(),
                             well ? format_duration(took.count()) : error_of(run)));
            edit = running.erase(edit);
        }
        std::this_thread::sleep_for(may_begin() ? std::chrono::milliseconds(1) : nap);
    }
}

}  // namespace item3d
