// A worker's sign of life, in a file that others read.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace item3d {

/// Rewrites workers/WORKER.json from a thread of its own: {"worker", "beat", "job", "process",
/// "threads", "ended"}. `beat` counts up; nobody compares clocks of machines. A file that cannot be
/// written is tried again: who takes that for a death takes the job over, and this worker finds out
/// before it publishes.
class Heartbeat {
  public:
    Heartbeat(const BatchFolder& folder, std::chrono::milliseconds every);
    /// Says that the worker has ended.
    ~Heartbeat();
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

    /// HOST-PID-XXXX, unlike that of any other worker of the batch.
    const std::string& worker() const { return worker_; }
    /// The job that the worker has in hand from now on; "" none.
    void set_job(const std::string& id);

  private:
    void beat_on();
    void write(bool ended);

    std::filesystem::path file_;
    std::string worker_;
    std::chrono::milliseconds every_;
    nlohmann::json process_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::string job_;
    std::int64_t beat_ = 0;
    bool stop_ = false;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace item3d
