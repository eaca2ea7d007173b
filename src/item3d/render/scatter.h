// Scattering of values at covered pixels into images.
#pragma once

#include "item3d/render/interpolate.h"

namespace item3d {

/// Scatters `values` [P, C] into an image [N, H, W, C]. All other pixels get `background`, which is
/// [C] or [N, H, W, C].
at::Tensor scatter(const at::Tensor& values, const Surface& surface, const Raster& raster,
                   const at::Tensor& background);

}  // namespace item3d
