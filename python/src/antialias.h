// Antialiasing of outlines.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Returns the neighbours of triangles [T, 3] as [T, 3] int32, in the form of Geometry::neighbours.
/// With positions [V, 3], vertices at equal positions count as one. Throws std::runtime_error.
Tensor neighbours(const Tensor& triangles, const std::optional<Tensor>& positions);

/// Antialiases an image [N, H, W, C] and returns it in the same shape. The inputs are raster
/// [N, H, W, 4], positions [N, V, 4] or [V, 4] (shared by all views), triangles [T, 3] and
/// neighbours [T, 3]. `max_steps` is the maximum number of triangles visited between two pixels.
/// With `bottom_up`, row 0 is the lowest. Throws std::runtime_error.
Tensor antialias(const Tensor& image, const Tensor& raster, const Tensor& positions,
                 const Tensor& triangles, const Tensor& neighbours, std::int64_t max_steps,
                 bool bottom_up);

/// Returns the gradients with respect to image and positions. The latter has shape [0] if
/// `positions_wanted` is false.
std::tuple<Tensor, Tensor> antialias_backward(const Tensor& image, const Tensor& raster,
                                              const Tensor& positions, const Tensor& triangles,
                                              const Tensor& neighbours, const Tensor& gradient,
                                              std::int64_t max_steps, bool bottom_up,
                                              bool positions_wanted);

}  // namespace item3d::python
