// Rasterisation.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// Rasterises positions [N, V, 4], or with ranges [N, 2] (first triangle, count) of each view [V,
/// 4]; triangles [T, 3]. Returns raster [N, H, W, 4] as in kernels/pixel_raster.h, and its slopes
/// [N, H, W, 4], or [N, H, W, 0] if not requested.
///
///
/// behind: [N, H, W] depths that visible surfaces must exceed. by_w: depth is w, not z/w.
/// bottom_up: row 0 is the lowest. finite: NaN and infinity in positions are an error; else
/// triangles with such a vertex are not drawn. Throws std::runtime_error.
std::tuple<Tensor, Tensor> rasterize(const Tensor& positions, const Tensor& triangles,
                                     const std::optional<Tensor>& ranges,
                                     const std::optional<Tensor>& behind, std::int64_t height,
                                     std::int64_t width, bool by_w, bool bottom_up, bool slopes,
                                     bool finite);

/// Returns the gradient of positions; slope_gradient: of the slopes, if it counts.
Tensor rasterize_backward(const Tensor& positions, const Tensor& triangles, const Tensor& raster,
                          const Tensor& raster_gradient,
                          const std::optional<Tensor>& slope_gradient, bool bottom_up);

}  // namespace item3d::python
