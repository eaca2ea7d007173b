// What the picture formats are decoded to, and how large it may be. Internal to io.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/scene/image_coding.h"

#include <cstdint>
#include <string>

namespace item3d {

struct DecodedImage {
    Image image;
    int bits_per_channel = 8;  ///< 8, 16 or 32
    /// How a changed copy is written where it is to be of the same kind: PNG for kinds that are not
    /// written, JPEG for those of them with losses.
    ImageCoding coding = {};
};

/// Refuses pictures that are too large (2^28 values) or that `available` bytes cannot hold even
/// when every byte stands for `most_pixels_per_byte` pixels, before anything is allocated.
void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                      std::uint64_t available, std::uint64_t most_pixels_per_byte,
                      const std::string& subject);

}  // namespace item3d
