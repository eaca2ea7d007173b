// A measure of the light that an edit baked into the base colour.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the correlation, in [-1, 1], of two values over P surface points. One is the change of
/// the base colour's log luminance (after - before). The other is the log luminance of the diffuse
/// light for the point's normal. The result is 1 if the colour became brighter exactly where the
/// light is, as if shading had been painted. It is 0 if the values are unrelated or one of them is
/// constant.
///
/// before, after: [P, 3] linear base colours; normals: [P, 3] unit, world space; light: an
/// equirectangular image, linear.
double baked_light(const at::Tensor& before, const at::Tensor& after, const at::Tensor& normals,
                   const Image& light);

}  // namespace item3d
