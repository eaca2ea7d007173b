#include "item3d/studio/jobs.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/studio/live_folder.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto poll_interval = std::chrono::milliseconds(50);
constexpr auto progress_interval = std::chrono::milliseconds(500);
constexpr auto longest_cancel = std::chrono::seconds(3);
constexpr auto longest_pause = std::chrono::seconds(60);
constexpr const char* checkpoint_name = "checkpoint.safetensors";
constexpr const char* summary_name = "edit.json";  ///< the last file that an edit writes

/// Returns the key of a result's events. An event replaces the earlier one with the same key.
std::string event_key(std::int64_t result) {
    return "result " + std::to_string(result);
}

/// Returns the arguments of a command, followed by the arguments that only the server needs.
std::vector<std::string> arguments_of(const StudioFolders& folders, const StudioCommand& command,
                                      const StudioResult& result) {
    std::vector<std::string> arguments = {folders.program(command.family).string()};
    arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
    const std::string live = result_folder_name(result.id) + "/" + live_folder_name;
    arguments.insert(arguments.end(), {"--progress-file", live + "/" + progress_file_name});
    if (result.kind == "edit") arguments.insert(arguments.end(), {"--live", live});
    if (fs::exists(folders.result(result.project, result.id) / checkpoint_name))
        arguments.emplace_back("--resume");
    return arguments;
}

}  // namespace

struct StudioJobs::Running {
    StudioResult result;
    std::unique_ptr<ChildProgram> program;
    LiveFolder live;
    JobClock clock;
    Clock::time_point begin = Clock::now();
    Clock::time_point told = {};
    Wish wish = Wish::none;
    Clock::time_point asked = {};

    double seconds() const { return std::chrono::duration<double>(Clock::now() - begin).count(); }
};

/// Returns a stage's progress, extended by the progress of the whole job.
nlohmann::json StudioJobs::told_progress(Running& running, nlohmann::json progress) {
    const double seconds = running.result.seconds + running.seconds();
    progress["seconds"] = seconds;
    if (const auto left = running.clock.seconds_left(progress, running.seconds())) {
        progress["job_seconds_left"] = std::round(10 * *left) / 10;
        progress["share"] = seconds / (seconds + *left);
    }
    return progress;
}

StudioJobs::StudioJobs(StudioStore& store, StudioEvents& events, const StudioFolders& folders,
                       const StudioCommands& commands, std::function<void(StudioResult&)> ended,
                       std::function<JobClock(const StudioResult&)> clock)
    : store_(store),
      events_(events),
      folders_(folders),
      commands_(commands),
      ended_(std::move(ended)),
      clock_(std::move(clock)) {
    for (StudioResult& result : store_.results_in(ResultState::running)) {
        result.state = ResultState::paused;
        store_.update_result(result);
    }
    for (StudioResult& result : store_.results_in(ResultState::paused))
        if (is_complete(result)) finish(result);
    thread_ = std::thread([this] { loop(); });
}

StudioJobs::~StudioJobs() {
    {
        const std::lock_guard guard(mutex_);
        stopping_ = true;
        if (running_ && running_->wish == Wish::none) {
            running_->wish = Wish::pause;
            running_->asked = Clock::now();
            running_->program->ask_to_end();
        }
        changed_.notify_all();
    }
    thread_.join();
}

/// True if an edit's last file exists. The command line may have finished the edit.
bool StudioJobs::is_complete(const StudioResult& result) const {
    return fs::exists(folders_.result(result.project, result.id) / summary_name);
}

void StudioJobs::loop() {
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            if (running_)
                changed_.wait_for(lock, poll_interval);
            else
                changed_.wait(lock, [this] { return stopping_ || may_begin_; });
            if (stopping_ && !running_) return;
            may_begin_ = false;
        }
        try {
            step();
            report_obstacle("");
        } catch (const std::exception& error) {
            // The cause is most likely a full disk. The running process continues and is checked
            // again.
            report_obstacle(message_of(error));
            std::this_thread::sleep_for(progress_interval);
            const std::lock_guard guard(mutex_);
            may_begin_ = true;
        }
    }
}

/// Watches the running process, or starts a waiting result.
void StudioJobs::step() {
    if (running_) {
        watch();
        return;
    }
    const std::vector<StudioResult> waiting = store_.results_in(ResultState::waiting);
    if (waiting.empty()) return;
    if (is_complete(waiting.front())) {
        finish(waiting.front());
        const std::lock_guard guard(mutex_);
        may_begin_ = true;
        return;
    }
    const std::lock_guard guard(mutex_);
    if (!stopping_) begin(waiting.front());
}

/// Reports to the log and the pages why the queue is blocked. An empty message: it is not.
void StudioJobs::report_obstacle(const std::string& message) {
    const std::string shown = message.empty() ? "" : folders_.without_paths(message);
    {
        const std::lock_guard guard(mutex_);
        if (std::exchange(obstacle_, shown) == shown) return;
    }
    if (!message.empty()) warn("queue: " + message);
    try {
        for (const ResultState state : {ResultState::waiting, ResultState::running})
            for (const StudioResult& result : store_.results_in(state))
                tell(result.id);
    } catch (const std::exception&) {
        // The database cannot be read either. The pages then get the message with the next change.
    }
}

/// Starts a result. If that fails, another result may start. The caller must hold the lock.
void StudioJobs::begin(StudioResult result) {
    may_begin_ = true;
    const auto stored = store_.result(result.id);
    if (!stored || stored->state != ResultState::waiting)
        return;  // the result was cancelled before its start
    try {
        const auto project = store_.project(result.project);
        const auto parent = result.parent ? store_.result(*result.parent) : std::nullopt;
        const StudioCommand command = commands_.make(*project, result, parent ? &*parent : nullptr);
        const fs::path folder = folders_.result(result.project, result.id);
        make_output_folder(folder / live_folder_name);
        auto running = std::make_unique<Running>();
        running->live = LiveFolder(folder / live_folder_name);
        running->live.clear();
        running->clock = clock_(result);
        result.state = ResultState::running;
        result.message.clear();
        store_.update_result(
            result);  // stored before the start, because running results cannot be removed
        running->program = std::make_unique<ChildProgram>(
            arguments_of(folders_, command, result), folder / "log.txt",
            ChildSurroundings{folders_.project(result.project), "item3d"});
        running->result = result;
        running_ = std::move(running);
        events_.send("result", result_json(result), event_key(result.id));
    } catch (const std::exception& error) {
        fail(std::move(result), message_of(error));
    }
}

void StudioJobs::fail(StudioResult result, const std::string& message) {
    result.state = ResultState::failed;
    result.message = folders_.without_paths(message);
    store_.update_result(result);
    events_.send("result", result_json(result), event_key(result.id));
}

void StudioJobs::watch() {
    const auto status = running_->program->status();
    if (status) {
        end(*status);
        return;
    }
    const auto now = Clock::now();
    {
        const std::lock_guard guard(mutex_);
        const auto longest =
            running_->wish == Wish::pause ? Clock::duration(longest_pause) : longest_cancel;
        if (running_->wish != Wish::none && now - running_->asked > longest) {
            running_->program->kill();
            return;
        }
    }
    const std::int64_t id = running_->result.id;
    if (auto preview = running_->live.new_preview()) {
        for (auto& texture : preview->at("textures"))
            texture["url"] = live_texture_url(id, texture.at("file"), preview->at("revision"));
        (*preview)["id"] = id;
        events_.send("preview", *preview, "preview " + std::to_string(id));
    }
    if (now - running_->told < progress_interval) return;
    running_->told = now;
    const auto progress = running_->live.new_progress();
    if (!progress) return;
    const std::lock_guard guard(mutex_);
    running_->result.progress = told_progress(*running_, *progress);
    const StudioResult told = running_->result;
    if (auto result = store_.result(id)) {  // includes changes that users made since the start
        result->progress = told.progress;
        events_.send("result", result_json(*result), event_key(id));
    }
}

void StudioJobs::end(int status) {
    const auto stored = store_.result(running_->result.id);  // may throw, and is then tried again
    std::unique_ptr<Running> ended;
    {
        const std::lock_guard guard(mutex_);
        ended = std::move(running_);
        may_begin_ = true;
    }
    if (!stored) return;
    StudioResult result = *stored;
    result.seconds += ended->seconds();
    const fs::path folder = folders_.result(result.project, result.id);
    if (ended->wish == Wish::remove) {
        remove_stored(result);
        return;
    }
    if (status == 0) {
        result.state = ResultState::done;
    } else if (ended->wish == Wish::cancel) {
        result.state = ResultState::cancelled;
    } else if (ended->wish == Wish::pause) {
        result.state = ResultState::paused;
    } else {
        result.state = ResultState::failed;
        result.message = folders_.without_paths(reason_of_end(folder / "log.txt", status));
    }
    if (result.state == ResultState::done)
        finish(std::move(result));
    else
        store_surely(result);
}

/// Stores the output of a finished command, which the queue or the user's command line has run.
void StudioJobs::finish(StudioResult result) {
    const fs::path folder = folders_.result(result.project, result.id);
    std::error_code ignored;
    // The checkpoint is as large as all other files together.
    fs::remove(folder / checkpoint_name, ignored);
    fs::remove_all(folder / live_folder_name, ignored);
    result.state = ResultState::done;
    try {
        ended_(result);
    } catch (const std::exception& error) {
        result.state = ResultState::failed;
        result.message = folders_.without_paths(message_of(error));
    }
    store_surely(result);
}

/// Stores the result, with retries while the disk is full.
void StudioJobs::store_surely(const StudioResult& result) {
    constexpr auto pause = std::chrono::seconds(1);
    for (;;) {
        try {
            store_.update_result(result);
            events_.send("result", result_json(result), event_key(result.id));
            return;
        } catch (const Error& error) {
            report_obstacle(error.what());
            const std::lock_guard guard(mutex_);
            if (stopping_) return;
        }
        std::this_thread::sleep_for(pause);
    }
}

StudioResult StudioJobs::add(StudioResult result) {
    const auto project = store_.project(result.project);
    if (!project) throw InputError("project", "does not exist");
    std::optional<StudioResult> parent;
    if (result.parent) {
        parent = store_.result(*result.parent);
        if (!parent || parent->project != result.project)
            throw InputError("parent", "is not a result of this project");
    }
    const StudioResult* begun_with = parent ? &*parent : nullptr;
    // Throws for an invalid request before anything is stored.
    commands_.make(*project, result, begun_with);
    StudioResult added = store_.add_result(result);
    added.command = shown_command(commands_.make(*project, added, begun_with));
    store_.update_result(added);
    added = with_status(added);
    events_.send("result", result_json(added), event_key(added.id));
    const std::lock_guard guard(mutex_);
    may_begin_ = true;
    changed_.notify_all();
    return added;
}

void StudioJobs::ask(std::int64_t id, Wish wish) {
    {
        const std::lock_guard guard(mutex_);
        if (running_ && running_->result.id == id) {
            running_->wish = wish;
            running_->asked = Clock::now();
            running_->program->ask_to_end();
            return;
        }
        auto result = store_.result(id);
        if (!result || (result->state != ResultState::waiting &&
                        !(wish == Wish::cancel && result->state == ResultState::paused)))
            return;
        result->state = wish == Wish::pause ? ResultState::paused : ResultState::cancelled;
        store_.update_result(*result);
    }
    tell(id);
}

void StudioJobs::pause(std::int64_t id) {
    ask(id, Wish::pause);
}

void StudioJobs::cancel(std::int64_t id) {
    ask(id, Wish::cancel);
}

void StudioJobs::resume(std::int64_t id) {
    {
        const std::lock_guard guard(mutex_);
        auto result = store_.result(id);
        if (!result || !has_ended(result->state) || result->state == ResultState::done) return;
        result->state = ResultState::waiting;
        result->message.clear();
        store_.update_result(*result);
        may_begin_ = true;
        changed_.notify_all();
    }
    tell(id);
}

void StudioJobs::remove(std::int64_t id) {
    const auto result = store_.result(id);
    if (!result) return;
    {
        const std::lock_guard guard(mutex_);
        if (running_ && running_->result.id == id) {
            running_->wish = Wish::remove;
            running_->asked = Clock::now();
            running_->program->ask_to_end();
            return;
        }
    }
    remove_stored(*result);
}

void StudioJobs::remove_stored(const StudioResult& result) {
    store_.remove_result(result.id);
    std::error_code ignored;
    fs::remove_all(folders_.result(result.project, result.id), ignored);
    events_.send("removed", {{"id", result.id}, {"project", result.project}});
}

StudioResult StudioJobs::with_status(StudioResult result) const {
    const std::lock_guard guard(mutex_);
    if (running_ && running_->result.id == result.id) result.progress = running_->result.progress;
    if (!has_ended(result.state)) result.message = obstacle_;
    return result;
}

void StudioJobs::tell(std::int64_t id) {
    if (const auto result = store_.result(id))
        events_.send("result", result_json(with_status(*result)), event_key(id));
}

}  // namespace item3d
