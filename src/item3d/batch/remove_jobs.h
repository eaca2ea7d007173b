// Removal of jobs from a batch.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <cstddef>
#include <string>
#include <vector>

namespace item3d {

/// Removes jobs from a batch. No worker begins removed jobs, and no page shows them. Their files
/// stay, and jobs that already run are finished. jobs: names, places ("jobs.csv: row 3"), folder
/// names or ids. Returns the number of removed jobs. Throws InputError, and removes no job, if one
/// of them is not found or is the predecessor of a job that stays.
std::size_t remove_jobs(const BatchFolder& folder, const std::vector<std::string>& jobs);

}  // namespace item3d
