// Equirectangular lights as differentiable tensors.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// [H, 2H, 3] equirectangular linear radiance -> [6, size, size, 3], differentiable.
at::Tensor equirectangular_to_cube(const at::Tensor& equirectangular, int size);

/// The light of lighting/environment.h's adjust_light, differentiable: [H, W, 3] equirectangular
/// radiance turned around +Y by `degrees` and multiplied by 2^exposure (scalar tensors). Columns
/// are interpolated, so the derivative by the angle is that of the line between two of them.
at::Tensor adjust_light(const at::Tensor& equirectangular, const at::Tensor& degrees,
                        const at::Tensor& exposure);

}  // namespace item3d
