// Smooth silhouettes, differentiable in the vertices.
#pragma once

#include "item3d/render/rasterize.h"

namespace item3d {

/// Blends pixel pairs across silhouette edges by the edge's exact crossing (Laine et al., section
/// 3.4); differentiable in `image` [N, H, W, C] and, through raster.positions_clip, in vertices.
at::Tensor antialias(const at::Tensor& image, const Raster& raster, const Geometry& geometry);

}  // namespace item3d
