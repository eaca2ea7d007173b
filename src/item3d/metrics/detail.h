// Preservation of a surface's pattern by an edit.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the correlation of luminance detail before and after, in [-1, 1]. 1 means that all
/// stripes, grain and edges are in place, in any colour. 0 means that none of them is left.
///
/// before, after: [N, 3, H, W] sRGB in [0, 1]; mask: [N, H, W], above 0.5 on the surface. The
/// detail of a pixel is its L* (CIELAB lightness divided by 100) minus a Gaussian mean of `sigma`
/// pixels inside the mask. Returns 0 if either image has no detail (standard deviation below
/// 0.001).
double detail_correlation(const at::Tensor& before, const at::Tensor& after, const at::Tensor& mask,
                          double sigma = 8.0);

/// Returns the standard deviation of the detail of one set of images.
double detail_strength(const at::Tensor& images, const at::Tensor& mask, double sigma = 8.0);

}  // namespace item3d
