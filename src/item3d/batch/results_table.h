// Table of a batch's results, results.csv, one row per job.
#pragma once

#include "item3d/batch/batch_view.h"

#include <string>

namespace item3d {

/// Returns CSV with the columns name, model, from, to, command, state, message, folder (of the
/// results), attempts, seconds, worker and options, and a column for each score that any job has
/// ("scores.detail_kept"). Replaced jobs are left out.
std::string results_csv(const BatchView& view);

}  // namespace item3d
