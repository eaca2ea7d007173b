// Measure of light baked into the base colour by an edit.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the correlation, in [-1, 1], of log(luminance after) - log(luminance before) of the base
/// colour with the log of the diffuse light's luminance for the normal, over P surface points. 1:
/// brighter exactly where the light is, as if shading had been painted; 0: unrelated, or one of the
/// two is constant.
///
/// before, after: [P, 3] linear base colours; normals: [P, 3] unit, world space; light: an
/// equirectangular image, linear.
double baked_light(const at::Tensor& before, const at::Tensor& after, const at::Tensor& normals,
                   const Image& light);

}  // namespace item3d
