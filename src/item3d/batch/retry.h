// Jobs that failed, once more.
#pragma once

#include "item3d/batch/batch_folder.h"

#include <cstddef>

namespace item3d {

/// Lets all current jobs that failed wait again, with their errors forgotten. Returns how many.
std::size_t retry_failed_jobs(const BatchFolder& folder);

}  // namespace item3d
