// Textures of few colours stay such.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Where the source has few colours, as what is painted by hand, covered texels of one of them
/// become one colour again: their mean, in `channels` (bit c: channel c), unless the edit tells
/// them apart by a root mean square of `blotch` or more. Values in [0, 1]; both images are of one
/// size, covered: [height * width].
void keep_flat(Image& image, const Image& source, const std::vector<std::uint8_t>& covered,
               unsigned channels, float blotch);

}  // namespace item3d
