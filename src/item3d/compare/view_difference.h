// Do pictures from several sides show one surface?
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Colours that a picture shows of P points of a surface.
struct PointColors {
    at::Tensor colors;  ///< [P, 3] sRGB
    at::Tensor seen;    ///< [P] bool
};

/// picture: [3, R, R] sRGB in [0, 1] of `camera`; counts: [1, R, R], 1 where the model covers the
/// pixel wholly, else 0; depth: [S, S] z-depths of the same view (Raster::depth), 0: none. A point
/// is seen where no surface stands before it, its normal is less than 60 degrees from the way to
/// the camera, and all pixels that its colour is taken of count. radius: of the model.
PointColors colors_of_points(const Surface& points, const Camera& camera, const at::Tensor& depth,
                             const at::Tensor& picture, const at::Tensor& counts, double radius);

/// Mean colour difference (CIE 1976, color.h) of the same point in two pictures, over all points
/// and all pairs of pictures that see them; 0: the pictures agree, 2.3 is just noticeable. NaN
/// where no point is seen twice. Highlights move over a surface, so that a shining model has more
/// than 0.
double view_difference(const std::vector<PointColors>& views);

}  // namespace item3d
