// The BSDF table of split-sum lighting.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the 2D BSDF table, computed by the build: [256, 256, 2] float32, row = roughness, column
/// = n.v, texel centres at (k + 0.5) / 256; specular albedo = F0 * A + B for GGX (alpha =
/// roughness^2) with height-correlated Smith masking.
const at::Tensor& bsdf_table();

}  // namespace item3d
