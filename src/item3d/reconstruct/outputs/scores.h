// Scores of the written model against the photographs.
#pragma once

#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct ViewScore {
    std::string name;
    double psnr = 0;          ///< PSNR in dB of the sRGB images over white
    double ssim = 0;          ///< SSIM of the sRGB images over white
    double mask_overlap = 0;  ///< intersection over union of coverage
};

/// Number of scored views whose images are kept in memory. Images of hundreds of views would take
/// gigabytes, so only the first views keep theirs.
inline constexpr std::size_t imaged_views = 8;

struct ScoredView {
    ViewScore score;
    Image truth, image;  ///< sRGB over white; empty after the first imaged_views views
};

/// Returns the means over views.
ViewScore mean_score(const std::vector<ScoredView>& views);

/// Renderer of a model from the views' cameras, as in `item3d render`.
class ModelRenderer {
  public:
    /// light: equirectangular. shadow_points: OcclusionOptions::max_points, or 0 for no shadows.
    ModelRenderer(const Model& model, const Image& light, std::int64_t shadow_points);

    /// Returns premultiplied linear radiance [1, H, W, 4].
    at::Tensor draw(const TargetView& view) const;
    /// Scores the views. `gain` multiplies each channel's radiance.
    std::vector<ScoredView> score(const std::vector<Photograph>& views, Vec3 gain = Vec3(1)) const;
    /// Returns the gain that fits the renders to the photographs, by least squares of linear
    /// radiance. Light and base colour are known only up to such a factor.
    Vec3 best_gain(const std::vector<Photograph>& views) const;
    /// Scores of views without a gain, and with each view's own best gain. The scores with gains
    /// suit photographs of different exposure.
    struct BothScores {
        std::vector<ScoredView> as_it_is, each_scaled;
    };
    BothScores score_both(const std::vector<Photograph>& views) const;
    /// Returns the views with cameras aligned so that renders, with one gain each, match their
    /// photographs. The object is around `centre`, within `radius`; the given cameras must be
    /// within a few pixels of the right ones.
    std::vector<Photograph> aligned(std::vector<Photograph> views, Vec3 centre, float radius) const;

  private:
    TargetView target(const Photograph& view) const;

    std::array<Vec3, 2> bounds_;
    Geometry geometry_;
    TexturedMaterials materials_;
    EnvironmentLight light_;
    std::shared_ptr<const Occlusion> occlusion_;
    std::shared_ptr<const IndirectLight> indirect_;
};

/// Returns the chamfer distance of points that are sampled evenly on two surfaces: the mean
/// distance from a point to the nearest point of the other surface. It is averaged over both
/// directions and divided by the diagonal of the reference's box.
double chamfer_distance(const TriangleMesh& mesh, const TriangleMesh& reference, int points = 20000,
                        std::uint64_t seed = 0);

/// Returns all triangles of a model.
TriangleMesh mesh_of(const Model& model);

}  // namespace item3d
