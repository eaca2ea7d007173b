// Rasterisation.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Rasterises triangles [T, 3] and returns raster [N, H, W, 4] as in kernels/pixel_raster.h, and
/// its slopes [N, H, W, 4], or [N, H, W, 0] if `slopes` is false. Positions are [N, V, 4]. With
/// `ranges` [N, 2], positions are [V, 4], and each view draws its own range of triangles, given by
/// the first index and the count.
///
/// If given, `behind` holds depths [N, H, W] that visible surfaces must exceed. With `by_w`, depth
/// is w instead of z/w. With `bottom_up`, row 0 is the lowest. With `finite`, NaN or infinity in a
/// position is an error; otherwise triangles with such a vertex are not drawn. Throws
/// std::runtime_error.
std::tuple<Tensor, Tensor> rasterize(const Tensor& positions, const Tensor& triangles,
                                     const std::optional<Tensor>& ranges,
                                     const std::optional<Tensor>& behind, std::int64_t height,
                                     std::int64_t width, bool by_w, bool bottom_up, bool slopes,
                                     bool finite);

/// Returns the gradient with respect to positions. `slope_gradient` is empty if the slopes have no
/// gradient.
Tensor rasterize_backward(const Tensor& positions, const Tensor& triangles, const Tensor& raster,
                          const Tensor& raster_gradient,
                          const std::optional<Tensor>& slope_gradient, bool bottom_up);

}  // namespace item3d::python
