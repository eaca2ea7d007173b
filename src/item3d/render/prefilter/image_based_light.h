// Prefiltering of a light for export to other programs.
#pragma once

#include "item3d/lighting/image_based_light.h"

namespace item3d {

/// Returns five levels with edges from `size` (a power of two, 256 to 1024) down to size / 16. The
/// first level is the light itself. The other levels are looked up in the chain of prefilter().
/// light: equirectangular, linear RGB.
ImageBasedLight make_image_based_light(const Image& light, int size = 256);

}  // namespace item3d
