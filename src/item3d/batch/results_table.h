// results.csv: a line for each job.
#pragma once

#include "item3d/batch/batch_view.h"

#include <string>

namespace item3d {

/// Columns: name, model, from, to, command, state, message, folder (of what the job left),
/// attempts, seconds, worker, options, and a column for each score that some job has
/// ("scores.detail_kept"). Jobs whose place others took are left out.
std::string results_csv(const BatchView& view);

}  // namespace item3d
