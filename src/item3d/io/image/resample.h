// Internal to scene/io.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// Bilinear between texel centres, edges held; the image itself when the size is right already.
Image resample(const Image& image, int width, int height);

}  // namespace item3d
