// Renders of a model before and after its edit, and their scores.
#pragma once

#include "item3d/edit/outputs/baked_files.h"
#include "item3d/edit/outputs/outside_texels.h"
#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/metrics/clip_score.h"
#include "item3d/report/report.h"

#include <optional>
#include <vector>

namespace item3d {

struct EditImages {
    std::vector<ReportImage> before;
    std::vector<ReportImage> after;
    std::vector<ReportImage> region;  ///< the region in the same views; empty if there is no region
    OutsideTexels outside;
    std::optional<ReportImage> turntable;  ///< set if the request asks for one
    SurfaceMeans means_before;
    SurfaceMeans means_after;
    double detail_kept = 0;  ///< correlation of luminance detail before and after (detail.h)
    std::optional<ClipScores> clip;
};

/// Renders the unedited and the edited model from the same views, each in its own light. Writes
/// before.png, after.png, turntable.webp and, if there is a region, region.png. If `clip` is not
/// null, also computes CLIP scores. Reuses the session's renders of the unedited model, and stores
/// the renders of the edited model in the session. The request's processes share out the renders of
/// whole models; only the first process returns images and writes files.
EditImages render_images(const EditRequest& request, const EditScene& scene,
                         const EditedModel& edited, const Clip* clip, EditSession& session);

}  // namespace item3d
