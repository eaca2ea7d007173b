// Measurements of a finished run, beside the edit's own record.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Returns the columns that every run has: {"case", "model" (as given), "from", "to", "method",
/// "prior", "seed", "expect", "options" (of the case, an object), "folder"}.
nlohmann::json row_of(const CompareRun& run, const CompareCase& test);

/// Returns row_of() and, for a run that has succeeded,
///   clip_global, clip_before, clip_directional   the edit's own scores, if there is a CLIP
///   seconds, peak_memory_bytes               not for a resumed run
///   unet_rows                 rows of the U-Net, as edit.json counts them
///   detail_kept               correlation of the luminance detail before and after
///   geometry_kept, uv_kept    true if positions and triangles, and UV maps, are unchanged
///   view_difference           view_difference.h, over six views in the edit's light; for
///                             controlnet-2d, over the images that it drew
///   light_baked               baked_light.h, in the edit's light
///   found, right              verdict.h, if the case has an expectation
///   pictures, images_before   run_images.h, drawn into the run's folder
/// else "error". Computed measures are kept in the run's measures.json.
nlohmann::json measured_run(const CompareRun& run, const CompareCase& test,
                            const ImageWishes& wishes);

}  // namespace item3d
