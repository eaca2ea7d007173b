// Turntable animations as small WebP files for browsers.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

#include <vector>

namespace item3d {

struct AnimationOptions {
    double frames_per_second = 24;
    float quality = 82;  ///< 0 to 100; the encoding is lossless at 100 and above, otherwise lossy
};

/// Encodes an endlessly looping animated WebP. Frames are sRGB images of one size with 3 or 4
/// channels (straight alpha).
Bytes encode_animation(const std::vector<Image>& frames, const AnimationOptions& options = {});

/// Encodes one frame as a still WebP image, for pages in which a PNG would be large.
Bytes encode_webp(const Image& image, float quality = 88);

}  // namespace item3d
