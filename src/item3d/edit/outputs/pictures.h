// Pictures of a model before and after its edit, and the scores that are taken of them.
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

struct Pictures {
    std::vector<ReportImage> before;
    std::vector<ReportImage> after;
    std::vector<ReportImage> region;  ///< of the same views; empty where all was to change
    OutsideTexels outside;
    std::optional<ReportImage> turntable;  ///< where the request wants one
    SurfaceMeans means_before;
    SurfaceMeans means_after;
    double detail_kept = 0;  ///< correlation of luminance detail before and after, see detail.h
    std::optional<ClipScores> clip;
};

/// Draws the same views of both models, each in its light; writes before.png, after.png,
/// region.png where there is a region, and turntable.webp. With `clip`, scores them too. Pictures
/// that the session has of the model are not drawn again; those of the edited one are left there.
/// The request's processes share out what is drawn of whole models; only the first one returns
/// pictures and writes.
Pictures render_pictures(const EditRequest& request, const EditScene& scene,
                         const EditedModel& edited, const Clip* clip, EditSession& session);

}  // namespace item3d
