// The largest shape that the masks allow.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/lattice.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <vector>

namespace item3d {

/// Signed distance in pixels from each pixel's centre to the outline of a mask, negative inside
/// (coverage of at least 0.5); exact between pixels of either kind (Felzenszwalb and Huttenlocher
/// 2012), half a pixel less so that the outline lies between them. image: coverage is its last
/// channel. One channel.
Image signed_distance(const Image& image);

/// Masks as distances, to ask about many points.
class VisualHull {
  public:
    explicit VisualHull(const std::vector<Photograph>& views);

    /// [P, 3] world -> [P] world units: about the signed distance to the hull, below 0 inside.
    /// In each picture a point has the distance to the outline, at the point's depth; the largest
    /// counts, or the one after the `ignored` largest, which poses that are a little off do not eat
    /// away. Pictures that do not show a point say nothing about it; what none shows is outside.
    at::Tensor distance(const at::Tensor& points, std::size_t ignored = 0) const;

    /// A box around the hull, looked for within `radius` of `centre`. Throws InputError that begins
    /// with `subject` where no point is inside all masks but `ignored`.
    std::array<Vec3, 2> bounds(Vec3 centre, float radius, const std::string& subject,
                               std::size_t ignored = 0) const;

    /// How far the outlines are from agreeing, in pixels: for object pixels of all views, how far
    /// outside the hull the ray through one stays at least; the mean. Exact poses and masks leave
    /// a tenth, however thin the parts. `views` are those that this was made of.
    double disagreement(const std::vector<Photograph>& views, Vec3 centre, float radius) const;

  private:
    struct Silhouette {
        Camera camera;
        Image distance;
    };
    std::vector<Silhouette> silhouettes_;
};

/// Around `bounds` with a few cells of room, `cells` along its longest edge.
Lattice make_lattice(std::array<Vec3, 2> bounds, int cells);

}  // namespace item3d
