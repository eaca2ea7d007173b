// How well what was written explains the photographs.
#pragma once

#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/scene/model.h"

#include <torch/types.h>

#include <string>
#include <vector>

namespace item3d {

struct ViewScore {
    std::string name;
    double psnr = 0;          ///< dB, sRGB over white
    double ssim = 0;          ///< sRGB over white
    double mask_overlap = 0;  ///< intersection over union of coverage
};

struct ScoredView {
    ViewScore score;
    Image truth, picture;  ///< sRGB over white
};

/// Means over views.
ViewScore mean_score(const std::vector<ScoredView>& views);

/// Draws `model` as `item3d render` does, from the views' cameras in `light`, and compares.
/// gain: multiplies each channel's radiance.
std::vector<ScoredView> score_views(const Model& model, const EnvironmentLight& light,
                                    const std::vector<TargetView>& views, Vec3 gain = Vec3(1));

/// The gain of each channel that brings renders nearest to the photographs, least squares of linear
/// radiance: light and base colour are known only up to such a factor.
Vec3 best_gain(const Model& model, const EnvironmentLight& light,
               const std::vector<TargetView>& views);

/// Mean of both directions' mean distances between points drawn evenly from two surfaces, over the
/// diagonal of the reference's box.
double chamfer_distance(const TriangleMesh& mesh, const TriangleMesh& reference, int points = 20000,
                        std::uint64_t seed = 0);

/// All triangles of a model.
TriangleMesh mesh_of(const Model& model);

}  // namespace item3d
