// Measurements of a run that has ended, beside the edit's own record.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// The part of a row that every run has: {"case", "model", "from", "to", "method", "prior",
/// "seed", "folder"}.
nlohmann::json row_of(const CompareRun& run, const CompareCase& test);

/// That, and of a run that has ended well
///   clip_global, clip_before, clip_directional   of the edit's own score, where there is a CLIP
///   seconds, peak_memory_bytes               not of a run that went on where it was cut off
///   unet_rows, detail_kept
///   geometry_kept, uv_kept    whether positions and triangles, and UV maps, are as they were
///   view_difference           view_difference.h, of six views in the edit's light; of
///                             controlnet-2d, of the pictures that it drew
///   light_baked               baked_light.h, in the edit's light
///   found, right              verdict.h, where the case expects something
///   pictures, pictures_before run_pictures.h, drawn into the run's folder
/// else "error". What had to be computed is kept in the run's measures.json.
nlohmann::json measured_run(const CompareRun& run, const CompareCase& test,
                            const PictureWishes& wishes);

}  // namespace item3d
