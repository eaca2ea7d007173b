// Convergence of an edit: an adjusted direction shrinks as the render approaches the target, down
// to noise.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// Returns the iteration at which the lengths (one an iteration) had converged; no value before
/// that. Converged: the mean of the last `window` is at most `part` of the mean of the first, in
/// both halves of the window, and the second half is at least 0.9 of the first, so that the edit
/// continues while the direction still shrinks. Not before three windows. Deterministic in the
/// curve: a resumed edit converges at the same iteration.
std::optional<std::int64_t> converged_at(const std::vector<float>& lengths, double part);

}  // namespace item3d
