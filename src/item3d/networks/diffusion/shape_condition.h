// The shape in a render, its depth and surface, as diffusion models want to see it.
#pragma once

#include "item3d/networks/diffusion/pipeline.h"

#include <torch/types.h>

namespace item3d {

/// What pictures show of a shape, at any resolution that is at least theirs.
struct SeenShape {
    torch::Tensor depth;  ///< [N, H, W] z-depth, 0: background
    /// What follows may be undefined for a ControlNet and for U-Nets that take depth alone.
    torch::Tensor position;  ///< [N, H, W, 3] in the model's bounding sphere as the unit sphere
    torch::Tensor normal;    ///< [N, H, W, 3] unit, in the same axes
};

/// z-depth [N, H, W] (0: nothing there) -> [N, 1, h, w] on the latents' grid: disparity scaled an
/// image to 0.2 (far) .. 1 (near), background -1, averaged over each latent cell.
torch::Tensor depth_condition(const torch::Tensor& depth, int downscale);

/// As a depth ControlNet's picture: z-depth [N, H, W] -> [N, 3, height, width], the same disparity
/// in all three channels on a background of 0, averaged over each pixel.
torch::Tensor depth_picture(const torch::Tensor& depth, std::int64_t height, std::int64_t width);

/// All that a U-Net may be told of a shape, small: [N, shape_cell_channels, h, w], its
/// depth_condition() and the mean position and normal of what covers each latent cell (0 where
/// nothing does).
inline constexpr int shape_cell_channels = 7;
torch::Tensor shape_cells(const SeenShape& shape, int downscale);

/// Further input channels of a U-Net that is told the surface, so that a pattern can lie in the
/// same place in every view: depth, normal, and sines and cosines of the position (as Mildenhall et
/// al. 2020, "NeRF", section 5.1), first of each coordinate in `space_waves` wavelengths, then of
/// `plane_waves` waves on the plane that the normal faces most: their sums make checks and dots.
inline constexpr int space_waves = 4;
inline constexpr int plane_waves = 12;
inline constexpr int surface_condition_channels = 4 + 6 * space_waves + 2 * plane_waves;

/// shape_cells() as the further input channels of a U-Net that has so many: none (undefined), 1
/// (depth, as Stable Diffusion 2's) or surface_condition_channels.
torch::Tensor shape_condition(const torch::Tensor& cells, int channels);

/// Whether the pipeline looks at the shape, by its U-Net's further channels or by a ControlNet.
bool takes_shape(const Pipeline& pipeline);

/// The condition of Pipeline::predict_noise for latents [N, C, h, w] of pictures that show this
/// shape, on the latents' device. Undefined where the pipeline takes none.
torch::Tensor condition_of_shape(const Pipeline& pipeline, const SeenShape& shape,
                                 const torch::Tensor& latents);

}  // namespace item3d
