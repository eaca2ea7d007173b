// The projection of texels to a view: which texels are visible, their positions in the image, and
// the cosines of the viewing angle.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

struct TexelView {
    at::Tensor place;   ///< [T, 2] x to the right and y down in the image, [0, 1] inside
    at::Tensor cosine;  ///< [T] between normal and direction to the camera; 0: invisible
};

/// Projects texels to a camera's image. depth: [S, S] z-depths of that camera (Raster::depth of one
/// view), preferably at a high resolution. tolerance: distance by which a visible texel may lie
/// behind them, in addition to its slope within a pixel. Back sides, which two-sided materials
/// show, are treated like front sides.
TexelView see_texels(const Surface& texels, const Camera& camera, const at::Tensor& depth,
                     float tolerance);

/// Returns bilinear values of a square image [C, R, R] at positions [T, 2]: [T, C]. Clamps to the
/// edge.
at::Tensor sample_image(const at::Tensor& image, const at::Tensor& places);

/// Bilinear values of valid pixels only: `counts` [1, R, R] is 0 or 1.
struct ImageSample {
    at::Tensor values;  ///< [T, C] weighted means of valid pixels
    at::Tensor share;   ///< [T] sum of their bilinear weights; values are 0 where it is 0
};
ImageSample sample_pixels(const at::Tensor& image, const at::Tensor& counts,
                          const at::Tensor& places);

}  // namespace item3d
