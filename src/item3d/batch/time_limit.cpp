#include "item3d/batch/time_limit.h"

#include "item3d/core/interrupt.h"

#include <chrono>

namespace item3d {

TimeLimit::TimeLimit(double seconds) {
    if (seconds <= 0) return;
    thread_ = std::thread([this, seconds] {
        std::unique_lock lock(mutex_);
        if (!wake_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return stop_; }))
            request_interrupt();
    });
}

TimeLimit::~TimeLimit() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

}  // namespace item3d
