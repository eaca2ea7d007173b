// Detection of dead workers.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <map>
#include <string>

namespace item3d {

/// Detector of lost workers. A worker is lost in three cases: its heartbeat has not changed for
/// `stale_after`, it wrote that it ended, or it ran on this machine and its process is gone. Time
/// is measured by this process's clock; clocks of different machines are never compared.
class WorkerWatch {
  public:
    using Clock = std::chrono::steady_clock;

    WorkerWatch(const BatchFolder& folder, std::chrono::milliseconds stale_after)
        : workers_(folder.workers()), stale_after_(stale_after) {}

    /// True if `worker` no longer works at `job`. The first call for a job begins to watch it.
    /// sign: further state, whose change also shows that the worker lives (the number of the
    /// attempt); now: the time.
    bool is_lost(const std::string& job, const std::string& worker, const std::string& sign,
                 Clock::time_point now = Clock::now());
    void forget(const std::string& job) { seen_.erase(job); }

  private:
    struct Seen {
        std::string sign;
        Clock::time_point since;
    };
    std::filesystem::path workers_;
    std::chrono::milliseconds stale_after_;
    std::map<std::string, Seen> seen_;  ///< by job
};

/// Returns the content of a worker's file; null if the file is missing or unreadable.
nlohmann::json read_heartbeat(const std::filesystem::path& file);

}  // namespace item3d
