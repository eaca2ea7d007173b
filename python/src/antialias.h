// Antialiasing of outlines.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// Returns the triangle across each edge of triangles [T, 3], [T, 3] int32, as in
/// Geometry::neighbours. positions [V, 3]: coincident vertices count as one. Throws
/// std::runtime_error.
Tensor neighbours(const Tensor& triangles, const std::optional<Tensor>& positions);

/// Antialiases image [N, H, W, C] to [N, H, W, C]. raster [N, H, W, 4], positions [N, V, 4] or for
/// all views [V, 4], triangles [T, 3], neighbours [T, 3]. max_steps: maximum number of triangles
/// visited between two pixels; bottom_up: row 0 is the lowest. Throws std::runtime_error.
Tensor antialias(const Tensor& image, const Tensor& raster, const Tensor& positions,
                 const Tensor& triangles, const Tensor& neighbours, std::int64_t max_steps,
                 bool bottom_up);

/// Returns the gradients of image and positions (of shape [0] if `positions_wanted` is false).
std::tuple<Tensor, Tensor> antialias_backward(const Tensor& image, const Tensor& raster,
                                              const Tensor& positions, const Tensor& triangles,
                                              const Tensor& neighbours, const Tensor& gradient,
                                              std::int64_t max_steps, bool bottom_up,
                                              bool positions_wanted);

}  // namespace item3d::python
