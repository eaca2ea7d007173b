// The shape in a render, its depth and surface, as diffusion models want to see it.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// What pictures show of a shape, at any resolution that is at least theirs.
struct SeenShape {
    at::Tensor depth;  ///< [N, H, W] z-depth, 0: background
    /// What follows may be undefined for a ControlNet and for U-Nets that take depth alone.
    at::Tensor position;  ///< [N, H, W, 3] in the model's bounding sphere as the unit sphere
    at::Tensor normal;    ///< [N, H, W, 3] unit, in the same axes
};

/// z-depth [N, H, W] (0: nothing there) -> [N, 1, h, w] on the latents' grid: disparity scaled an
/// image to 0.2 (far) .. 1 (near), background -1, averaged over each latent cell.
at::Tensor depth_condition(const at::Tensor& depth, int downscale);

/// As a depth ControlNet's picture: z-depth [N, H, W] -> [N, 3, height, width], the same disparity
/// in all three channels on a background of 0, averaged over each pixel.
at::Tensor depth_picture(const at::Tensor& depth, std::int64_t height, std::int64_t width);

/// All that a U-Net may be told of a shape, small: [N, shape_cell_channels, h, w], its
/// depth_condition() and the mean position and normal of what covers each latent cell (0 where
/// nothing does).
inline constexpr int shape_cell_channels = 7;
at::Tensor shape_cells(const SeenShape& shape, int downscale);

/// Further input channels of a U-Net that is told the surface, so that a pattern can lie in the
/// same place in every view: depth, normal, and sines and cosines of the position (as Mildenhall et
/// al. 2020, "NeRF", section 5.1), first of each coordinate in `space_waves` wavelengths, then of
/// `plane_waves` waves on the plane that the normal faces most: their sums make checks and dots.
inline constexpr int space_waves = 4;
inline constexpr int plane_waves = 12;
inline constexpr int surface_condition_channels = 4 + 6 * space_waves + 2 * plane_waves;

/// shape_cells() as the further input channels of a U-Net that has so many: none (undefined), 1
/// (depth, as Stable Diffusion 2's) or surface_condition_channels.
at::Tensor shape_condition(const at::Tensor& cells, int channels);

/// Whether the pipeline looks at the shape, by its U-Net's further channels or by a ControlNet.
bool takes_shape(const DiffusionModel& model);

/// The condition of DiffusionModel::predict_noise for latents [N, C, h, w] of pictures that show
/// this shape, on the latents' device. Undefined where the pipeline takes none.
at::Tensor condition_of_shape(const DiffusionModel& model, const SeenShape& shape,
                              const at::Tensor& latents);

}  // namespace item3d
