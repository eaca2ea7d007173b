// Visual hull: the largest shape consistent with the masks.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/lattice.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <vector>

namespace item3d {

/// Returns an image of one channel: the signed distance in pixels from each pixel's centre to the
/// outline of a mask. The distance is negative inside the mask, where coverage is at least 0.5. It
/// is the exact distance to the nearest pixel centre on the other side of the outline (Felzenszwalb
/// and Huttenlocher 2012), less half a pixel. So the outline lies between pixel centres. image: its
/// last channel is coverage.
Image signed_distance(const Image& image);

/// Visual hull from the masks' distance fields.
class VisualHull {
  public:
    explicit VisualHull(const std::vector<Photograph>& views);

    /// Returns the approximate signed distances [P] from points [P, 3] to the hull, in world space
    /// and units. They are negative inside the hull. Each image gives the point's distance to the
    /// outline, converted to world units at the point's depth. The result is the largest of these
    /// distances after the `ignored` largest ones are left out, so that slightly inexact poses do
    /// not erode the hull. Images that do not show a point are skipped. A point that no image shows
    /// is outside.
    at::Tensor distance(const at::Tensor& points, std::size_t ignored = 0) const;

    /// Returns a box around the hull, searched within `radius` of `centre`. Throws InputError that
    /// begins with `subject` if no point is inside all masks except `ignored` of them.
    std::array<Vec3, 2> bounds(Vec3 centre, float radius, const std::string& subject,
                               std::size_t ignored = 0) const;

    /// Returns the outlines' inconsistency in pixels. It is the mean, over object pixels of all
    /// views, of the distance between the pixel's ray and the hull. This distance is 0 if the ray
    /// meets the hull. Exact poses and masks give about a tenth of a pixel, even for thin parts.
    /// `views` are those given to the constructor.
    double disagreement(const std::vector<Photograph>& views, Vec3 centre, float radius) const;

  private:
    struct Silhouette {
        Camera camera;
        Image distance;
    };
    std::vector<Silhouette> silhouettes_;
};

/// Returns a lattice around `bounds`, with a margin of a few cells, and with `cells` cells along
/// its longest edge.
Lattice make_lattice(std::array<Vec3, 2> bounds, int cells);

}  // namespace item3d
