// How much of a mesh's outlines the masks of photographs show.
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
    double agreement = 0;      ///< the same, but what is off by little more than a pixel is right
    double masks_covered = 0;  ///< part of the masks that the outlines cover
};

/// Coverage alone, shrunk until the object has about as many pixels as a square of that side.
Image compared_mask(const Image& image, double side);

/// Draws a mesh's outlines in some of the views and compares.
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
