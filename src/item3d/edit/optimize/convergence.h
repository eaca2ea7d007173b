// Whether an edit has arrived: a direction that is adjusted shrinks as the render comes to look
// like the target, and what is left then is noise.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// The iteration at which the lengths (one an iteration) had converged; no value while they have
/// not. Converged: the mean of the last `window` is at most `part` of the mean of the first, in
/// both halves of it, and the second half is no shorter than 0.9 of the first, so that a direction
/// that still shrinks goes on. Not before three windows. A function of the curve alone: a resumed
/// edit converges where it would have.
std::optional<std::int64_t> converged_at(const std::vector<float>& lengths, double part);

}  // namespace item3d
