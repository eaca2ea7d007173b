// Detection of an edit's convergence: the length of an adjusted direction falls to the level of its
// noise as the render approaches the target.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// Returns the iteration at which the direction's lengths (one value an iteration) converged; no
/// value if they have not. The last 50 iterations form a window of two halves. The lengths have
/// converged when the mean of each half is at most `part` of the mean of the first 50 iterations,
/// and the mean of the second half is at least 0.9 of that of the first half (the direction no
/// longer shrinks). Convergence takes at least 150 iterations. The result depends on `lengths` and
/// `part` alone, so that a resumed edit converges at the same iteration.
std::optional<std::int64_t> converged_at(const std::vector<float>& lengths, double part);

}  // namespace item3d
