// The queue: commands of the studio as processes of their own, one at a time, each in the folder of
// its result.
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

/// Thread-safe. Every change is in the store before the pages hear of it.
class StudioJobs {
  public:
    /// Results that ran when an earlier server ended are paused, or done where the command line has
    /// ended them since. ended: called by the queue's thread with a result that is done, before
    /// that is told; what it throws makes it fail. clock: of a result that begins.
    StudioJobs(StudioStore& store, StudioEvents& events, const StudioFolders& folders,
               const StudioCommands& commands, std::function<void(StudioResult&)> ended,
               std::function<JobClock(const StudioResult&)> clock);
    /// What runs is asked to end, and is paused.
    ~StudioJobs();
    StudioJobs(const StudioJobs&) = delete;
    StudioJobs& operator=(const StudioJobs&) = delete;

    /// Stores the result and lets it wait for its turn. Throws InputError for a request that makes
    /// no command.
    StudioResult add(StudioResult result);
    /// Asks what runs to keep what it has and end; what waits does not run until resume().
    void pause(std::int64_t id);
    void cancel(std::int64_t id);
    /// What has ended without being done waits for its turn again and goes on where it was; it is
    /// done then where the command line has ended it since.
    void resume(std::int64_t id);
    /// Cancels it and removes it with its folder.
    void remove(std::int64_t id);

    /// With the progress of what runs.
    StudioResult with_progress(StudioResult result) const;
    /// Tells the pages of the result as the store has it.
    void tell(std::int64_t id);

  private:
    enum class Wish { none, pause, cancel, remove };
    struct Running;

    void loop();
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
    bool may_begin_ = true;             ///< something may wait for its turn
    std::unique_ptr<Running> running_;  ///< made and ended by the queue's thread alone
    std::thread thread_;
};

}  // namespace item3d
