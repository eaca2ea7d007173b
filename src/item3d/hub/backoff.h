// Retries of a failed request, with growing waiting times.
#pragma once

#include "item3d/hub/http.h"

#include <cstdint>

namespace item3d {

struct RetryPolicy {
    int attempts = 6;
    double first_wait = 1;  ///< seconds; each further wait is twice as long
};

/// Counter of the failures of one request. When new bytes have arrived, it starts again.
class Backoff {
  public:
    explicit Backoff(RetryPolicy policy) : policy_(policy) {}
    /// Counts a failure and waits before the next attempt. bytes_done: total of the bytes received.
    /// Throws ResourceError if the last allowed attempt has failed, and Interrupted after Ctrl-C.
    void wait(const ConnectionError& failure, std::uint64_t bytes_done = 0);

  private:
    RetryPolicy policy_;
    int failures_ = 0;
    std::uint64_t bytes_done_ = 0;
};

/// Returns the result of `request`, which is retried if it throws ConnectionError.
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
