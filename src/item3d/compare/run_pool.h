// Processes of edits, several at a time where memory allows.
#pragma once

#include "item3d/compare/runs.h"

#include <vector>

namespace item3d {

/// Runs what has not ended well before. A further one begins beside another only where as much
/// memory is free as the largest has taken so far (2 GB before one has ended). One that fails
/// leaves its error for error_of() and ends nothing else; one that was cut off goes on where it
/// was. Throws Interrupted once those that run have kept what they had.
void perform_runs(const std::vector<CompareRun>& runs, const CompareOptions& options);

}  // namespace item3d
