// Equirectangular lights as differentiable tensors.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Converts equirectangular linear radiance [H, 2H, 3] to a cube [6, size, size, 3].
/// Differentiable.
at::Tensor equirectangular_to_cube(const at::Tensor& equirectangular, int size);

/// Returns equirectangular radiance [H, W, 3] that is turned around +Y by `degrees` and multiplied
/// by 2^exposure. Both are scalar tensors. This is adjust_light() of lighting/environment.h in a
/// differentiable form. Columns are interpolated linearly, so the derivative with respect to the
/// angle is piecewise constant.
at::Tensor adjust_light(const at::Tensor& equirectangular, const at::Tensor& degrees,
                        const at::Tensor& exposure);

}  // namespace item3d
