// Prefiltering of a light for export to other programs.
#pragma once

#include "item3d/lighting/image_based_light.h"

namespace item3d {

/// light: equirectangular, linear RGB. Returns five levels from `size` (a power of two, 256 to
/// 1024) down to size / 16. The first is the light itself; the others are lookups in the chain of
/// prefilter().
ImageBasedLight make_image_based_light(const Image& light, int size = 256);

}  // namespace item3d
