// Time limit that interrupts the process.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace item3d {

/// Calls request_interrupt() after the given time, unless destroyed before.
class TimeLimit {
  public:
    /// seconds: 0 or less for no limit.
    explicit TimeLimit(double seconds);
    ~TimeLimit();
    TimeLimit(const TimeLimit&) = delete;
    TimeLimit& operator=(const TimeLimit&) = delete;

  private:
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace item3d
