// Gallery page of a batch, index.html.
#pragma once

#include "item3d/batch/batch_view.h"

#include <string>

namespace item3d {

/// Optional thumbnails of the model before and after the job, in the job's folder.
inline constexpr const char* before_thumbnail = "before.webp";
inline constexpr const char* after_thumbnail = "after.webp";

/// Returns an HTML page that needs no network. It shows each job's scores and its images before and
/// after, with failed jobs first, and has a filter. The page of a batch with up to 2000 finished
/// jobs embeds the images. The page of a larger batch loads them from the jobs' folders on
/// scrolling.
std::string gallery_html(const BatchFolder& folder, const BatchView& view);

}  // namespace item3d
