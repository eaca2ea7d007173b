// Textures no larger than what they show.
#pragma once

#include "item3d/field/atlas/uv_raster.h"
#include "item3d/scene/image.h"

namespace item3d {

/// The image halved while bilinear lookups still give all of its texels: 1 x 1 for a plain colour.
/// Of the difference, the root mean square stays below 1/255 in each channel and the largest below
/// 4/255; values in [0, 1].
Image shrink(Image image, UvWrap wrap);

}  // namespace item3d
