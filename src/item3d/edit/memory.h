// Whether an edit fits into memory, told before it starts.
#pragma once

#include "item3d/edit/edit.h"

namespace item3d {

/// What `--memory` stands for: whether to trade time for memory. "high" and "low" say it; "auto"
/// looks at the prior's headers and at what is free, and says what it chose where that is not the
/// usual. Warns where even the low estimate does not fit. Throws ResourceError when the weights
/// alone do not, InputError on another word.
bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device);

}  // namespace item3d
