// Retry of failed jobs.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <cstddef>

namespace item3d {

/// Makes all failed jobs wait again, except removed and replaced ones, and clears their errors.
/// Returns the number of these jobs.
std::size_t retry_failed_jobs(const BatchFolder& folder);

}  // namespace item3d
