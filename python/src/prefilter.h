// Prefiltering of environments for shading.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Resamples an equirectangular map [H, W, 3] to a cube map [6, size, size, 3] with the faces in
/// OpenGL's order. Throws std::runtime_error.
Tensor equirectangular(const Tensor& map, std::int64_t size);

/// Returns the gradient with respect to equirectangular()'s map [height, width, 3].
Tensor equirectangular_backward(const Tensor& gradient, std::int64_t height, std::int64_t width);

/// Prefilters a cube [6, S, S, 3], where S is a power of two in [16, 1024]. Returns four things:
/// the maps, namely the irradiance / pi [6, 128, 128, 3] followed by the specular levels; weights
/// of each map, which the gradient needs; the roughness [L] of the L levels; and the indices of the
/// texels whose irradiance is summed exactly, [64] int64. Throws std::runtime_error.
std::tuple<std::vector<Tensor>, std::vector<Tensor>, Tensor, Tensor> prefilter(const Tensor& cube);

/// Returns the gradient with respect to prefilter()'s cube. `gradients` are those with respect to
/// the irradiance and the levels.
Tensor prefilter_backward(const std::vector<Tensor>& gradients, const std::vector<Tensor>& weights,
                          const Tensor& bright, std::int64_t size);

}  // namespace item3d::python
