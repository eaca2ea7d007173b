// How much of the light of an edit is painted into the base colour?
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Correlation, in [-1, 1], of what changed in the base colour with the light that falls there:
/// of log(luminance after) - log(luminance before) with the log of the diffuse light's luminance on
/// the normal, over P points of the surface. 1: brighter exactly where the light is, as if shading
/// had been painted; 0: not related, or one of the two does not vary at all.
///
/// before, after: [P, 3] linear base colours; normals: [P, 3] unit, world space; light: an
/// equirectangular picture, linear.
double baked_light(const at::Tensor& before, const at::Tensor& after, const at::Tensor& normals,
                   const Image& light);

}  // namespace item3d
