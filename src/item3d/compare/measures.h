// The measurements of a finished run. Some come from the edit's own record, edit.json; the others
// are computed here.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Returns the columns that every run has: "case", "model" (as given), "from", "to", "method",
/// "prior", "seed", "expect", "options" (those of the case, an object) and "folder".
nlohmann::json row_of(const CompareRun& run, const CompareCase& test);

/// Returns row_of(). For a run that has succeeded, the row also has these columns:
///   clip_global, clip_before, clip_directional   scores of edit.json, if there is a CLIP
///   seconds, peak_memory_bytes               unless the run was resumed
///   unet_rows                 rows of all batches that the U-Net computed (edit.json)
///   detail_kept               correlation of the luminance detail before and after
///   geometry_kept, uv_kept    true if positions and triangles, and UV maps, are unchanged
///   view_difference           view_difference.h, over six views in the edit's light; for
///                             controlnet-2d, over the images that it drew
///   light_baked               baked_light.h, in the edit's light
///   found, right              verdict.h, if the case has an expectation
///   pictures, images_before   run_images.h, drawn into the run's folder
/// For any other run it has "error" instead. Computed measures are kept in the run's measures.json.
nlohmann::json measured_run(const CompareRun& run, const CompareCase& test,
                            const ImageWishes& wishes);

}  // namespace item3d
