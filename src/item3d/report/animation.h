// Turntable animations as small WebP files for browsers.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

#include <vector>

namespace item3d {

struct AnimationOptions {
    double frames_per_second = 24;
    float quality = 82;  ///< 0 to 100, lossy; 100 and above is lossless
};

/// Encodes an endlessly looping animated WebP. Frames are sRGB of one size, 3 or 4 channels
/// (straight alpha).
Bytes encode_animation(const std::vector<Image>& frames, const AnimationOptions& options = {});

/// Encodes one frame as still WebP, for pages where PNG would be large.
Bytes encode_webp(const Image& image, float quality = 88);

}  // namespace item3d
