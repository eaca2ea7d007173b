// Gallery page of a batch, index.html.
#pragma once

#include "item3d/batch/batch_view.h"

#include <string>

namespace item3d {

/// Optional thumbnails in a job's folder, of the model before and after.
inline constexpr const char* before_thumbnail = "before.webp";
inline constexpr const char* after_thumbnail = "after.webp";

/// Returns a page that opens offline: before and after of each job, its scores, failures first,
/// with a filter. For up to 2000 finished jobs images are embedded; for more they are loaded from
/// the jobs' folders on scrolling.
std::string gallery_html(const BatchFolder& folder, const BatchView& view);

}  // namespace item3d
