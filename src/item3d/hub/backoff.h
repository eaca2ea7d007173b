// How often, and after what waits, a failed request is tried again.
#pragma once

#include "item3d/hub/http.h"

#include <cstdint>

namespace item3d {

struct RetryPolicy {
    int attempts = 6;
    double first_wait = 1;  ///< seconds; each further wait is twice the one before
};

/// Counts the failures of one request. Bytes that arrived in between start the count anew.
class Patience {
  public:
    explicit Patience(RetryPolicy policy) : policy_(policy) {}
    /// Waits before the next try. Throws ResourceError after the last, and Interrupted.
    void wait(const ConnectionError& failure, std::uint64_t bytes_done = 0);

  private:
    RetryPolicy policy_;
    int failures_ = 0;
    std::uint64_t bytes_done_ = 0;
};

/// The result of `request`, tried again where it throws ConnectionError.
template <typename Request>
auto with_patience(RetryPolicy policy, const Request& request) {
    Patience patience(policy);
    for (;;) {
        try {
            return request();
        } catch (const ConnectionError& failure) {
            patience.wait(failure);
        }
    }
}

}  // namespace item3d
