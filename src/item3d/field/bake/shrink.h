// Reduction of textures to the resolution of their content.
#pragma once

#include "item3d/field/atlas/uv_raster.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Halves the image while bilinear lookups still reproduce all of its texels: 1 x 1 for a plain
/// colour. The root mean square error stays below `tolerance` in each channel and the largest error
/// below four times as much; values in [0, 1].
Image shrink(Image image, UvWrap wrap, float tolerance = 1.0f / 255);

/// Halves the image like shrink() until it is no wider and no higher than `size`.
Image halved_to(Image image, const Image& size);

}  // namespace item3d
