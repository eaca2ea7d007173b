// The detection of an edit's convergence. As the render approaches the target, the length of an
// adjusted direction falls to the level of its noise.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// Returns the iteration at which the direction's lengths converged; no value if they have not.
/// lengths: one value for each iteration. The last 50 iterations form a window of two halves. The
/// lengths have converged if two conditions hold. The mean of each half is at most `part` times the
/// mean of the first 50 iterations. And the mean of the second half is at least 0.9 times that of
/// the first half, which shows that the direction no longer shrinks. Convergence takes at least 150
/// iterations. The result depends only on `lengths` and `part`, so that a resumed edit converges at
/// the same iteration.
std::optional<std::int64_t> converged_at(const std::vector<float>& lengths, double part);

}  // namespace item3d
