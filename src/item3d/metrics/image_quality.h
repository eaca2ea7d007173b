// Image quality against a reference: PSNR and SSIM.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the peak signal-to-noise ratio in dB, at most 100. Both tensors have the same shape,
/// with values in [0, 1].
double psnr(const at::Tensor& image, const at::Tensor& truth);

/// Returns the structural similarity (Wang et al. 2004) of [N, C, H, W] in [0, 1], mean over all;
/// 1: equal. Gaussian window of 11 pixels, sigma 1.5, no padding: images of at least 11 pixels a
/// side.
double ssim(const at::Tensor& image, const at::Tensor& truth);

}  // namespace item3d
