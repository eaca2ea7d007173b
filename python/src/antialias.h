// Smooth outlines.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// triangles [T, 3] -> the triangle across each edge, [T, 3] int32, as Geometry::neighbours says.
/// positions [V, 3]: vertices at one place are one. Throws std::runtime_error.
Tensor neighbours(const Tensor& triangles, const std::optional<Tensor>& positions);

/// image [N, H, W, C], raster [N, H, W, 4], positions [N, V, 4] or for all views [V, 4], triangles
/// [T, 3], neighbours [T, 3] -> [N, H, W, C]. most_steps: triangles that are looked at between two
/// pixels; bottom_up: row 0 is the lowest. Throws std::runtime_error.
Tensor antialias(const Tensor& image, const Tensor& raster, const Tensor& positions,
                 const Tensor& triangles, const Tensor& neighbours, std::int64_t most_steps,
                 bool bottom_up);

/// Gradients by image and positions (of shape [0] where `positions_wanted` is false).
std::tuple<Tensor, Tensor> antialias_backward(const Tensor& image, const Tensor& raster,
                                              const Tensor& positions, const Tensor& triangles,
                                              const Tensor& neighbours, const Tensor& gradient,
                                              std::int64_t most_steps, bool bottom_up,
                                              bool positions_wanted);

}  // namespace item3d::python
