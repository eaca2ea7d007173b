// The BSDF table of split-sum lighting. It holds A and B of kernels/bsdf.h. F0 A + B is the
// directional albedo of GGX with Schlick's Fresnel term (Karis 2013).
//
//     table  [256, 256, 2]
//     row     0 .. 255   roughness (row + 1/2) / 256        last axis:  A, B
//     column  0 .. 255   n.v (column + 1/2) / 256
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the BSDF table [256, 256, 2] float32, which is computed at build time. A row is a
/// roughness, a column is an n.v, and texel centres are at (k + 0.5) / 256. GGX has alpha =
/// roughness^2 and height-correlated Smith masking.
const at::Tensor& bsdf_table();

}  // namespace item3d
