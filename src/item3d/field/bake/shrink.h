// Textures no larger than what they show.
#pragma once

#include "item3d/field/atlas/uv_raster.h"
#include "item3d/scene/image.h"

namespace item3d {

/// The image halved while bilinear lookups still give all of its texels: 1 x 1 for a plain colour.
/// The root mean square of the difference stays below `tolerance` in each channel and the largest
/// difference below four times as much; values in [0, 1].
Image shrink(Image image, UvWrap wrap, float tolerance = 1.0f / 255);

/// The image halved as shrink() halves until it is no wider and no higher than `size`.
Image halved_to(Image image, const Image& size);

}  // namespace item3d
