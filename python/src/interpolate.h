// Interpolation of vertex attributes at pixels.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// Interpolates attributes [N, V, A], or one for all views [1, V, A] or [V, A]; raster [N, H, W,
/// 4]; triangles [T, 3]; slopes [N, H, W, 4] of rasterize(), if the slopes of the channels `sloped`
/// are required. Returns [N, H, W, A] and [N, H, W, 2 * sloped]. Throws std::runtime_error.
std::tuple<Tensor, Tensor> interpolate(const Tensor& attributes, const Tensor& raster,
                                       const Tensor& triangles, const std::optional<Tensor>& slopes,
                                       const std::vector<std::int64_t>& sloped);

/// Returns the gradients of attributes (of shape [0] if `attributes_wanted` is false), raster and
/// slopes (of shape [0] without slopes).
std::tuple<Tensor, Tensor, Tensor> interpolate_backward(
    const Tensor& attributes, const Tensor& raster, const Tensor& triangles,
    const std::optional<Tensor>& slopes, const std::vector<std::int64_t>& sloped,
    const Tensor& value_gradient, const Tensor& value_slope_gradient, bool attributes_wanted);

}  // namespace item3d::python
