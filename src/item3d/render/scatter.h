// Scattering of values at covered pixels into images.
#pragma once

#include "item3d/render/interpolate.h"

namespace item3d {

/// Scatters [P, C] values into [N, H, W, C] with `background` [C] or [N, H, W, C] elsewhere.
at::Tensor scatter(const at::Tensor& values, const Surface& surface, const Raster& raster,
                   const at::Tensor& background);

}  // namespace item3d
