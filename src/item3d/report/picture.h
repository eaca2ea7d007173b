// From linear radiance to pictures that people look at.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>

namespace item3d {

/// Premultiplied linear RGBA -> sRGB in [0, 1] as PNG files hold it: straight alpha, or composed
/// over `background` (linear) with three channels. An RGB image is only encoded.
Image to_display(const Image& linear, std::optional<Vec3> background = std::nullopt);

/// Straight-alpha sRGB RGBA over a plain sRGB colour, blended in linear light: three channels.
/// Grey and RGB images are only brought to three channels.
Image flatten(const Image& picture, Vec3 background);

/// Shrinks by box filter or enlarges bilinearly so that the picture is width x height; alpha is
/// taken as premultiplied, which flat pictures and RGB are.
Image resize(const Image& image, int width, int height);

/// Shrinks so that the longer side is at most `longest`; smaller pictures stay as they are.
Image thumbnail(const Image& image, int longest);

}  // namespace item3d
