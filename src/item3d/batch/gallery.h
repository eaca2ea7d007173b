// index.html: the page of a batch.
#pragma once

#include "item3d/batch/batch_view.h"

#include <string>

namespace item3d {

/// Small pictures that a job may leave in its folder, of the model before and after.
inline constexpr const char* before_thumbnail = "before.webp";
inline constexpr const char* after_thumbnail = "after.webp";

/// One page that opens offline: before and after of each job, its scores, failures first, with a
/// filter. Of up to 2000 jobs that are done, pictures are inside the page; of more, they are read
/// from the jobs' folders as one scrolls.
std::string gallery_html(const BatchFolder& folder, const BatchView& view);

}  // namespace item3d
