// Job queue. It runs the studio's commands as separate processes, one at a time, each in the folder
// of its result.
#pragma once

#include "item3d/core/child_program.h"
#include "item3d/studio/commands.h"
#include "item3d/studio/events.h"
#include "item3d/studio/job_clock.h"
#include "item3d/studio/store.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace item3d {

/// Job queue. Thread-safe. Every change is stored before the pages hear of it.
class StudioJobs {
  public:
    /// Results that ran when an earlier server ended become paused, or become done if the command
    /// line has finished them since then. ended: function that the queue's thread calls with a
    /// finished result before the pages are notified; if it throws, the result fails. clock:
    /// function that returns the clock for a result about to start.
    StudioJobs(StudioStore& store, StudioEvents& events, const StudioFolders& folders,
               const StudioCommands& commands, std::function<void(StudioResult&)> ended,
               std::function<JobClock(const StudioResult&)> clock);
    /// Asks the running process to end, and pauses its result.
    ~StudioJobs();
    StudioJobs(const StudioJobs&) = delete;
    StudioJobs& operator=(const StudioJobs&) = delete;

    /// Stores the result and queues it. Throws InputError for a request that makes no command.
    StudioResult add(StudioResult result);
    /// Asks a running process to save its state and end. A waiting result is held until resume().
    void pause(std::int64_t id);
    void cancel(std::int64_t id);
    /// Queues an unfinished result again, to continue from its saved state. If the command line has
    /// finished it since then, it becomes done instead.
    void resume(std::int64_t id);
    /// Cancels the result and removes it with its folder.
    void remove(std::int64_t id);

    /// Returns the result with its progress if it is running, and with the reason if the queue is
    /// blocked, for example by a full disk.
    StudioResult with_status(StudioResult result) const;
    /// Sends the stored result to the pages.
    void tell(std::int64_t id);

  private:
    enum class Wish { none, pause, cancel, remove };
    struct Running;

    void loop();
    void step();
    void report_obstacle(const std::string& message);
    bool is_complete(const StudioResult& result) const;
    void begin(StudioResult result);
    static nlohmann::json told_progress(Running& running, nlohmann::json progress);
    void watch();
    void end(int status);
    void finish(StudioResult result);
    void store_surely(const StudioResult& result);
    void fail(StudioResult result, const std::string& message);
    void ask(std::int64_t id, Wish wish);
    void remove_stored(const StudioResult& result);

    StudioStore& store_;
    StudioEvents& events_;
    const StudioFolders& folders_;
    const StudioCommands& commands_;
    std::function<void(StudioResult&)> ended_;
    std::function<JobClock(const StudioResult&)> clock_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stopping_ = false;
    bool may_begin_ = true;             ///< true if a result may be waiting
    std::string obstacle_;              ///< reason why the queue is blocked; empty if it is not
    std::unique_ptr<Running> running_;  ///< created and ended only by the queue's thread
    std::thread thread_;
};

}  // namespace item3d
