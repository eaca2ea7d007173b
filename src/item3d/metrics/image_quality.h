// Image quality against a reference: PSNR and SSIM.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the peak signal-to-noise ratio in dB, at most 100. Both tensors have the same shape,
/// with values in [0, 1].
double psnr(const at::Tensor& image, const at::Tensor& truth);

/// Returns the structural similarity (Wang et al. 2004) of images [N, C, H, W] in [0, 1], as the
/// mean over all pixels, channels and images. 1 means equal. The window is a Gaussian of 11 pixels
/// with sigma 1.5. There is no padding, so images must have at least 11 pixels a side.
double ssim(const at::Tensor& image, const at::Tensor& truth);

}  // namespace item3d
