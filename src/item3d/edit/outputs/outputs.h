// What an edit leaves in its folder.
#pragma once

#include "item3d/edit/edit.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/surface_means.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/timing.h"
#include "item3d/metrics/clip_score.h"
#include "item3d/report/report.h"

#include <optional>
#include <vector>

namespace item3d {

/// model.glb as it was written and read back: pictures and scores are of this, not of the field.
struct EditedModel {
    Model model;
    std::vector<TexturePair> textures;
    std::optional<Image> light;  ///< the new one, where the light was optimised
};

/// Writes model.glb and textures/; where the texture is not edited, model.glb alone, with all its
/// bytes. Where the light is, light.hdr and light.exr.
EditedModel bake_and_save(const EditRequest& request, const EditScene& scene, EditState& state);

struct Pictures {
    std::vector<ReportImage> before;
    std::vector<ReportImage> after;
    ReportImage turntable;
    SurfaceMeans means_before;
    SurfaceMeans means_after;
    double detail_kept = 0;  ///< correlation of luminance detail before and after, see detail.h
    std::optional<ClipScores> clip;
};

/// Draws the same views of both models, each in its light; writes before.png, after.png and
/// turntable.webp. With `clip`, scores them too.
Pictures render_pictures(const EditRequest& request, const EditScene& scene,
                         const EditedModel& edited, const std::optional<Clip>& clip);

/// Writes report.html and edit.json; returns the latter's content.
nlohmann::json write_summary(const EditRequest& request, const EditScene& scene,
                             const EditState& state, const StageTimes& times,
                             const IterationTimes& iteration_times, const EditedModel& edited,
                             const Pictures& pictures);

}  // namespace item3d
