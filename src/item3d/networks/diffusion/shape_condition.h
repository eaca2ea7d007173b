// Conditioning of diffusion models on a shape: its depth and surface in a render.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Depth, position and normal of a shape in rendered images, at the images' resolution or a higher
/// one. Position and normal may be undefined for a ControlNet and for U-Nets that take depth alone.
struct SeenShape {
    at::Tensor depth;  ///< [N, H, W] z-depth; 0 for the background
    /// [N, H, W, 3] in axes that make the model's bounding sphere the unit sphere.
    at::Tensor position;
    at::Tensor normal;  ///< [N, H, W, 3] unit, in the same axes
};

/// Converts z-depth [N, H, W] (0 for the background) to [N, 1, h, w] on the latents' grid. The
/// result is the disparity, which is scaled in each image to 0.2 (far) .. 1 (near), and -1 in the
/// background, averaged over each latent cell.
at::Tensor depth_condition(const at::Tensor& depth, int downscale);

/// Converts z-depth [N, H, W] to the image of a depth ControlNet, [N, 3, height, width]: the scaled
/// disparity in all three channels, and 0 in the background, averaged over each pixel.
at::Tensor depth_image(const at::Tensor& depth, std::int64_t height, std::int64_t width);

/// Channels of shape_cells().
inline constexpr int shape_cell_channels = 7;
/// Returns the shape at latent resolution, [N, shape_cell_channels, h, w]: depth_condition(), and
/// the mean position and normal of the surface in each cell (0 where there is none).
at::Tensor shape_cells(const SeenShape& shape, int downscale);

/// Channels of a surface condition: depth, normal, and sines and cosines of the position (as in
/// Mildenhall et al. 2020, "NeRF", section 5.1). They let a pattern keep its place on the surface
/// in every view. `space_waves` waves run along each coordinate axis. A further `plane_waves` waves
/// run along the coordinate plane that is most perpendicular to the normal; sums of these waves
/// make checks and dots.
inline constexpr int space_waves = 4;
inline constexpr int plane_waves = 12;
inline constexpr int surface_condition_channels = 4 + 6 * space_waves + 2 * plane_waves;

/// Converts shape_cells() to `channels` input channels of a U-Net: 0 (the result is undefined), 1
/// (depth, as in Stable Diffusion 2) or surface_condition_channels.
at::Tensor shape_condition(const at::Tensor& cells, int channels);

/// True if the pipeline takes a shape, by its U-Net's extra channels or by a ControlNet.
bool takes_shape(const DiffusionModel& model);

/// Returns the condition of DiffusionModel::predict_noise for latents [N, C, h, w] of images of
/// this shape, on the latents' device. Undefined if the pipeline takes no shape or the depth is
/// undefined.
at::Tensor condition_of_shape(const DiffusionModel& model, const SeenShape& shape,
                              const at::Tensor& latents);

}  // namespace item3d
