// Equirectangular lights as differentiable tensors.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Converts [H, 2H, 3] equirectangular linear radiance to [6, size, size, 3]; differentiable.
at::Tensor equirectangular_to_cube(const at::Tensor& equirectangular, int size);

/// Differentiable adjust_light() of lighting/environment.h: [H, W, 3] equirectangular radiance
/// turned around +Y by `degrees` and multiplied by 2^exposure (scalar tensors). Columns are
/// interpolated linearly, so the derivative with respect to the angle is piecewise constant.
at::Tensor adjust_light(const at::Tensor& equirectangular, const at::Tensor& degrees,
                        const at::Tensor& exposure);

}  // namespace item3d
