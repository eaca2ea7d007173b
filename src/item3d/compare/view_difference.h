// The consistency of images of one surface from several sides.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// The colours of P surface points in one image.
struct PointColors {
    at::Tensor colors;  ///< [P, 3] sRGB
    at::Tensor seen;    ///< [P] bool
};

/// Samples the colours of surface points in an image. image: [3, R, R], sRGB in [0, 1], as `camera`
/// sees the model; counts: [1, R, R], 1 where the model covers the pixel wholly, else 0; depth: [S,
/// S] z-depths of the same view (Raster::depth), 0 where there is no surface. A point is seen if no
/// surface occludes it, its normal is less than 60 degrees from the direction to the camera, and
/// `counts` is 1 for all sampled pixels. radius: the model's.
PointColors colors_of_points(const Surface& points, const Camera& camera, const at::Tensor& depth,
                             const at::Tensor& image, const at::Tensor& counts, double radius);

/// Returns the mean difference between the colours of one point in two images (CIE 1976, color.h).
/// The mean is over all points and all pairs of images that see the point. 0 means that the images
/// agree; 2.3 is just noticeable. NaN if no point is seen twice. Highlights move over a surface, so
/// the result for a shiny model is above 0.
double view_difference(const std::vector<PointColors>& views);

}  // namespace item3d
