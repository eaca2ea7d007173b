// The BSDF table of split-sum lighting: A and B of kernels/bsdf.h, F0 A + B being the directional
// albedo of GGX with Schlick's Fresnel term (Karis 2013).
//
//     table  [256, 256, 2]
//     row     0 .. 255   roughness (row + 1/2) / 256        last axis:  A, B
//     column  0 .. 255   n.v (column + 1/2) / 256
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the 2D BSDF table, computed at build time: [256, 256, 2] float32, row = roughness,
/// column = n.v, texel centres at (k + 0.5) / 256; specular albedo = F0 * A + B for GGX (alpha =
/// roughness^2) with height-correlated Smith masking.
const at::Tensor& bsdf_table();

}  // namespace item3d
