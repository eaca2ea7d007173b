// Preservation of flat colours in textures of few colours.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Sets covered texels that have one colour in the source to their mean, in `channels` (bit c:
/// channel c), unless the edit makes them differ by a root mean square of `blotch` or more. Does
/// nothing if the source has many colours; hand-painted textures have few. Values in [0, 1]; both
/// images have the same size, covered: [height * width].
void keep_flat(Image& image, const Image& source, const std::vector<std::uint8_t>& covered,
               unsigned channels, float blotch);

}  // namespace item3d
