// Overlap of a mesh's outlines with the masks of photographs.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/dataset/placement.h"
#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/render/interpolate.h"

#include <array>
#include <vector>

namespace item3d {

struct OutlineOverlap {
    double iou = 0;            ///< intersection over union of all pixels
    double agreement = 0;      ///< `iou` with a tolerance of little more than a pixel
    double masks_covered = 0;  ///< fraction of the masks' area that the outlines cover
};

/// Returns the image's coverage channel, shrunk until the object covers about side^2 pixels.
Image compared_mask(const Image& image, double side);

/// Renderer of a mesh's outlines in some views, for comparison with their masks.
class OutlineViews {
  public:
    /// side: see compared_mask().
    OutlineViews(const TriangleMesh& mesh, const std::vector<Photograph>& views, double side);

    OutlineOverlap compare(const Placement& placement, bool with_agreement = false) const;
    const std::array<Vec3, 2>& mesh_bounds() const { return bounds_; }

  private:
    struct View {
        Camera camera;
        Image mask, distance;
    };
    Geometry geometry_;
    std::array<Vec3, 2> bounds_;
    std::vector<View> views_;
};

}  // namespace item3d
