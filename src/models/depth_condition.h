// The depth of a render as diffusion models want to see it.
#pragma once

#include "item3d/models/pipeline.h"

#include <torch/types.h>

namespace item3d {

/// As the U-Net's fifth channel: z-depth [N, H, W] (0: nothing there) -> [N, 1, h, w] on the
/// latents' grid: disparity scaled an image to 0.2 (far) .. 1 (near), background -1, averaged over
/// each latent cell.
torch::Tensor depth_condition(const torch::Tensor& depth, int downscale);

/// As a depth ControlNet's picture: z-depth [N, H, W] -> [N, 3, height, width], the same disparity
/// in all three channels on a background of 0, averaged over each pixel.
torch::Tensor depth_picture(const torch::Tensor& depth, std::int64_t height, std::int64_t width);

/// Whether the pipeline looks at depth, by its U-Net's fifth channel or by a ControlNet.
bool takes_depth(const Pipeline& pipeline);

/// The condition of Pipeline::predict_noise for latents [N, C, h, w] of pictures with this z-depth
/// [N, H, W], on the latents' device. The depth may be finer than the pictures were. Undefined
/// where the pipeline takes none.
torch::Tensor condition_of_depth(const Pipeline& pipeline, const torch::Tensor& depth,
                                 const torch::Tensor& latents);

}  // namespace item3d
