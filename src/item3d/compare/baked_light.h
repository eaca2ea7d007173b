// Measure of light baked into the base colour by an edit.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the correlation, in [-1, 1], of two values over P surface points: the change of the base
/// colour's log luminance (after - before), and the log luminance of the diffuse light for the
/// point's normal. 1: the colour became brighter exactly where the light is, as if shading had been
/// painted; 0: unrelated, or one of the two is constant.
///
/// before, after: [P, 3] linear base colours; normals: [P, 3] unit, world space; light: an
/// equirectangular image, linear.
double baked_light(const at::Tensor& before, const at::Tensor& after, const at::Tensor& normals,
                   const Image& light);

}  // namespace item3d
