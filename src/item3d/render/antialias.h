// Antialiasing of silhouettes, differentiable in the vertices.
#pragma once

#include "item3d/render/rasterize.h"

namespace item3d {

/// Blends the two pixels of each pair across a silhouette edge, weighted by where the edge crosses
/// the line between their centres (Laine et al. 2020, section 3.4). Differentiable in `image` [N,
/// H, W, C] and, through raster.positions_clip, in the vertices.
at::Tensor antialias(const at::Tensor& image, const Raster& raster, const Geometry& geometry);

}  // namespace item3d
