// A pool of processes for edits, which run several at a time if memory allows.
#pragma once

#include "item3d/compare/runs.h"

#include <vector>

namespace item3d {

/// Performs the runs that have not succeeded before. While runs are active, another run starts only
/// if as much memory is free as the largest run so far has used (2 GB until the first run has
/// ended). A failed run leaves its error for error_of() and stops no other run; an interrupted run
/// is resumed. Throws Interrupted after the active runs have saved their state.
void perform_runs(const std::vector<CompareRun>& runs, const CompareOptions& options);

}  // namespace item3d
