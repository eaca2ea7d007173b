// Reduction of textures to the resolution of their content.
#pragma once

#include "item3d/field/atlas/uv_raster.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Halves the image repeatedly, as long as bilinear lookups still reproduce all texels of the given
/// image. A plain colour becomes 1 x 1. In each channel, the root mean square error stays below
/// `tolerance`, and the largest error below four times `tolerance`. Values are in [0, 1].
Image shrink(Image image, UvWrap wrap, float tolerance = 1.0f / 255);

/// Halves the image, as shrink() does, until it is no wider and no higher than `size`.
Image halved_to(Image image, const Image& size);

}  // namespace item3d
