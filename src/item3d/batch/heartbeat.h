// Heartbeat of a worker, in a file that other workers read.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace item3d {

/// Periodic writer of workers/WORKER.json, in its own thread: {"worker", "beat", "job", "process",
/// "threads", "ended"}. `beat` is a counter, so that clocks of different machines are never
/// compared. A failed write is retried. The other workers may take a long pause between two beats
/// for this worker's death. One of them then takes over its job, which this worker notices before
/// it publishes.
class Heartbeat {
  public:
    Heartbeat(const BatchFolder& folder, std::chrono::milliseconds every);
    /// Writes into the file that the worker has ended.
    ~Heartbeat();
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

    /// Returns the worker's name, HOST-PID-XXXX, which is unique among the batch's workers.
    const std::string& worker() const { return worker_; }
    /// Sets the worker's current job; "" for none.
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
    std::thread thread_;  // last: it uses all members above
};

}  // namespace item3d
