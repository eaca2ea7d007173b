// Preservation of flat colours in textures of few colours.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Sets the covered texels that have the same colour in the source to their mean, unless the edit
/// makes them differ by a root mean square of `blotch` or more. Does nothing if the source has many
/// colours, unlike a hand-painted texture. Values are in [0, 1], and both images have the same
/// size. covered: [height * width]; channels: bit mask of the channels to change, bit c for channel
/// c.
void keep_flat(Image& image, const Image& source, const std::vector<std::uint8_t>& covered,
               unsigned channels, float blotch);

}  // namespace item3d
