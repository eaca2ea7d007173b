// The way from a view's pixels back to texels: which texels a camera sees, where in its picture,
// and how squarely.
#pragma once

#include "item3d/render/interpolate.h"
#include "item3d/scene/camera.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

struct TexelView {
    at::Tensor place;   ///< [T, 2] x to the right and y down in the picture, [0, 1] inside of it
    at::Tensor cosine;  ///< [T] between normal and the way to the camera; 0: not seen
};

/// depth: [S, S] z-depths of that camera (Raster::depth of one view), the finer the better.
/// tolerance: distance by which a texel may lie behind them, besides its slope within a pixel.
/// A back side, which materials with two sides show, is seen as the front is not.
TexelView see_texels(const Surface& texels, const Camera& camera, const at::Tensor& depth,
                     float tolerance);

/// Bilinear values of a square picture [C, R, R] at places [T, 2]: [T, C]. Beyond the middle of the
/// outermost pixels their values go on.
at::Tensor sample_picture(const at::Tensor& picture, const at::Tensor& places);

/// The same of pixels that count alone: `counts` [1, R, R] of 0 and 1.
struct PictureSample {
    at::Tensor values;  ///< [T, C] weighted means of those
    at::Tensor share;   ///< [T] of the bilinear weights that they have; values are 0 where it is 0
};
PictureSample sample_pixels(const at::Tensor& picture, const at::Tensor& counts,
                            const at::Tensor& places);

}  // namespace item3d
