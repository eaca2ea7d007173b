// The projection of texels to a view: which texels are visible, their positions in the image, and
// the cosines of the viewing angle.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

struct TexelView {
    at::Tensor place;   ///< [T, 2] x to the right, y down; in [0, 1] inside the image
    at::Tensor cosine;  ///< [T] cosine of the angle between normal and camera; 0: invisible
};

/// Projects texels to a camera's image. depth: [S, S] z-depths of that camera (Raster::depth of one
/// view), preferably at a high resolution. tolerance: distance by which a visible texel may lie
/// behind the stored depth, in addition to the change of depth within a pixel. Texels whose normals
/// point away from the camera are invisible.
TexelView see_texels(const Surface& texels, const Camera& camera, const at::Tensor& depth,
                     float tolerance);

/// Returns the values [T, C] of a square image [C, R, R] at positions [T, 2]. The lookup is
/// bilinear and clamps to the edge.
at::Tensor sample_image(const at::Tensor& image, const at::Tensor& places);

/// Bilinear values of the valid pixels of an image.
struct ImageSample {
    at::Tensor values;  ///< [T, C] weighted means of valid pixels
    at::Tensor share;   ///< [T] sum of the valid pixels' bilinear weights; if 0, so are the values
};
ImageSample sample_pixels(const at::Tensor& image, const at::Tensor& counts,
                          const at::Tensor& places);

}  // namespace item3d
