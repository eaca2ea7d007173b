// Interpolation of vertex attributes at pixels.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Interpolates vertex attributes at the pixels of raster [N, H, W, 4]. The attributes are
/// [N, V, A], or [1, V, A] or [V, A] if all views share them; triangles are [T, 3]. Returns values
/// [N, H, W, A] and the slopes of the channels in `sloped`, [N, H, W, 2 * size of sloped]. The
/// latter require the slopes [N, H, W, 4] of rasterize(). Throws std::runtime_error.
std::tuple<Tensor, Tensor> interpolate(const Tensor& attributes, const Tensor& raster,
                                       const Tensor& triangles, const std::optional<Tensor>& slopes,
                                       const std::vector<std::int64_t>& sloped);

/// Returns the gradients with respect to attributes (of shape [0] if `attributes_wanted` is false),
/// raster, and slopes (of shape [0] without slopes).
std::tuple<Tensor, Tensor, Tensor> interpolate_backward(
    const Tensor& attributes, const Tensor& raster, const Tensor& triangles,
    const std::optional<Tensor>& slopes, const std::vector<std::int64_t>& sloped,
    const Tensor& value_gradient, const Tensor& value_slope_gradient, bool attributes_wanted);

}  // namespace item3d::python
