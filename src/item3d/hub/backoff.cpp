#include "item3d/hub/backoff.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace item3d {

void Backoff::wait(const ConnectionError& failure, std::uint64_t bytes_done) {
    if (bytes_done > bytes_done_) failures_ = 0;
    bytes_done_ = std::max(bytes_done, bytes_done_);
    if (++failures_ >= policy_.attempts)
        throw ResourceError(
            fmt::format("{} (tried {} times); run the same command again later to continue",
                        failure.what(), failures_));
    const double seconds = policy_.first_wait * std::exp2(failures_ - 1);
    note(fmt::format("pull: {}; trying again in {}", failure.what(), format_duration(seconds)));
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        if (interrupted()) throw Interrupted("during the download");
        const auto left = end - std::chrono::steady_clock::now();
        std::this_thread::sleep_for(
            std::min<std::chrono::duration<double>>(left, std::chrono::milliseconds(50)));
    }
}

}  // namespace item3d
