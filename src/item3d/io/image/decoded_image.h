// The result of decoding an image, and limits on an image's size. Internal to io.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/scene/image_coding.h"

#include <cstdint>
#include <string>

namespace item3d {

struct DecodedImage {
    Image image;
    int bits_per_channel = 8;  ///< 8, 16 or 32
    /// Coding of a changed copy: the format of this image if it can be written, else JPEG for a
    /// lossy format and PNG for a lossless one.
    ImageCoding coding = {};
};

/// Throws InputError, before anything is allocated, for images that are too large (2^28 values) or
/// that `available` bytes cannot hold even if every byte encodes `max_pixels_per_byte` pixels.
void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                      std::uint64_t available, std::uint64_t max_pixels_per_byte,
                      const std::string& subject);

}  // namespace item3d
