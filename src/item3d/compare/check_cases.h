// Checks of a comparison's cases before any run starts.
#pragma once

#include "item3d/compare/runs.h"

namespace item3d {

/// Throws InputError that names the first case with a value that an edit would refuse: of each
/// option (check_option()), of all settings together with each prior and method, and a word to
/// expect that a prior lacks, for cases of a file. Models are not loaded.
void check_cases(const CompareOptions& options);

}  // namespace item3d
