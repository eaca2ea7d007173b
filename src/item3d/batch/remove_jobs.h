// Jobs that a batch shall not do after all.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <cstddef>
#include <string>
#include <vector>

namespace item3d {

/// Takes jobs out of a batch: they are not begun, and no page shows them. What they have written
/// stays, and one that runs is finished. jobs: each its name, its place ("jobs.csv: row 3"), its
/// folder's name or id. Returns how many there were. Throws InputError, and removes nothing, where
/// one is not found or another job, which stays, comes after it.
std::size_t remove_jobs(const BatchFolder& folder, const std::vector<std::string>& jobs);

}  // namespace item3d
