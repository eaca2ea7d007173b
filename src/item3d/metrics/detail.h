// How much of a surface's pattern an edit kept.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Correlation of luminance detail before and after, in [-1, 1]; 1: all stripes, grain and edges
/// stand where they stood, however their colour changed; 0: nothing of them is left.
///
/// before, after: [N, 3, H, W] sRGB in [0, 1]; mask: [N, H, W], above 0.5 where the surface is. The
/// detail of a pixel is its L* (CIELAB lightness, / 100) less the mean of its surroundings inside
/// the mask, a Gaussian of `sigma` pixels. Returns 0 where either picture has no detail at all
/// (standard deviation below 0.001).
double detail_correlation(const at::Tensor& before, const at::Tensor& after, const at::Tensor& mask,
                          double sigma = 8.0);

/// Standard deviation of that detail, one picture set alone.
double detail_strength(const at::Tensor& images, const at::Tensor& mask, double sigma = 8.0);

}  // namespace item3d
