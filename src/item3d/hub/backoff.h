// Retries of a failed request: their number and waiting times.
#pragma once

#include "item3d/hub/http.h"

#include <cstdint>

namespace item3d {

struct RetryPolicy {
    int attempts = 6;
    double first_wait = 1;  ///< seconds; doubles for each further wait
};

/// Counts the failures of one request. Received bytes reset the count.
class Backoff {
  public:
    explicit Backoff(RetryPolicy policy) : policy_(policy) {}
    /// Waits before the next attempt. Throws ResourceError if the last allowed attempt has failed,
    /// and Interrupted after Ctrl-C.
    void wait(const ConnectionError& failure, std::uint64_t bytes_done = 0);

  private:
    RetryPolicy policy_;
    int failures_ = 0;
    std::uint64_t bytes_done_ = 0;
};

/// Returns the result of `request`, retrying where it throws ConnectionError.
template <typename Request>
auto with_patience(RetryPolicy policy, const Request& request) {
    Backoff backoff(policy);
    for (;;) {
        try {
            return request();
        } catch (const ConnectionError& failure) {
            backoff.wait(failure);
        }
    }
}

}  // namespace item3d
