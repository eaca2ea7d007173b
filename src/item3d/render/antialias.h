// Antialiasing of silhouettes, differentiable in the vertices.
#pragma once

#include "item3d/render/rasterize.h"

namespace item3d {

/// Blends each pair of pixels that lie on both sides of a silhouette edge (Laine et al. 2020,
/// section 3.4). The weight depends on where the edge crosses the line between the pixels' centres.
/// Differentiable in `image` [N, H, W, C] and, through raster.positions_clip, in the vertices.
at::Tensor antialias(const at::Tensor& image, const Raster& raster, const Geometry& geometry);

}  // namespace item3d
