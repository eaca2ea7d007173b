// The checks of a comparison's cases before any run starts.
#pragma once

#include "item3d/compare/runs.h"

namespace item3d {

/// Throws InputError that names the first case that an edit would refuse. Checks each option
/// (check_option()), and all settings together for each prior and method. For cases of a file, also
/// checks that each prior knows the expected word. Does not load the models.
void check_cases(const CompareOptions& options);

}  // namespace item3d
