// Conversion of linear radiance to display images, and their sizes.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>

namespace item3d {

/// Converts premultiplied linear RGBA to sRGB in [0, 1] as in PNG files. Without `background`
/// (linear), the result has straight alpha. With it, the result is composited over this colour and
/// has three channels. An RGB image is only encoded.
Image to_display(const Image& linear, std::optional<Vec3> background = std::nullopt);

/// Composites straight-alpha sRGB RGBA over a plain sRGB colour, in linear light. The result has
/// three channels. Grey and RGB images are only converted to three channels.
Image flatten(const Image& image, Vec3 background);

/// Resizes to width x height. Shrinking uses a box filter, and enlarging is bilinear. Alpha must be
/// premultiplied or absent.
Image resize(const Image& image, int width, int height);

/// Shrinks so that the longer side is at most `longest`; smaller images are unchanged.
Image thumbnail(const Image& image, int longest);

}  // namespace item3d
