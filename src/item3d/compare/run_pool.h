// Pool of edit processes, several at a time as memory allows.
#pragma once

#include "item3d/compare/runs.h"

#include <vector>

namespace item3d {

/// Performs the runs that have not succeeded before. A further one starts beside another only if as
/// much memory is free as the largest has used so far (2 GB before one has ended). A failed run
/// leaves its error for error_of() and stops nothing else; an interrupted one is resumed. Throws
/// Interrupted after the running ones have saved their state.
void perform_runs(const std::vector<CompareRun>& runs, const CompareOptions& options);

}  // namespace item3d
