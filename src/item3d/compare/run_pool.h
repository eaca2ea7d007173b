// Pool of edit processes, several at a time as memory allows.
#pragma once

#include "item3d/compare/runs.h"

#include <vector>

namespace item3d {

/// Performs the runs that have not succeeded before. While runs are active, another starts only if
/// as much memory is free as the largest run has used so far (2 GB before the first has ended). A
/// failed run leaves its error for error_of() and stops no other run; an interrupted run is
/// resumed. Throws Interrupted after the active runs have saved their state.
void perform_runs(const std::vector<CompareRun>& runs, const CompareOptions& options);

}  // namespace item3d
