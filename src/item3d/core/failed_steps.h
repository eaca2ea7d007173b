// Detection of an optimisation that has diverged.
#pragma once

#include <cstdint>

namespace item3d {

/// Counts failed steps in a row. A step fails if a prediction or a gradient is not finite. One
/// failed step can be an overflow in half precision; the step is then skipped. Many in a row mean
/// that no later step will succeed.
class FailedSteps {
  public:
    explicit FailedSteps(std::int64_t limit = 10) : limit_(limit) {}

    /// Counts a step. Returns true if this step and all previous ones up to the limit have failed.
    bool too_many_after(bool failed) {
        in_a_row_ = failed ? in_a_row_ + 1 : 0;
        return in_a_row_ >= limit_;
    }
    std::int64_t limit() const { return limit_; }

  private:
    std::int64_t limit_;
    std::int64_t in_a_row_ = 0;
};

}  // namespace item3d
