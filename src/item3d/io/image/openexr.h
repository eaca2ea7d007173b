// OpenEXR images. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// subject: name of the image in errors. Throws InputError.
DecodedImage decode_openexr(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Encodes with ZIP compression, in half precision if bits_per_channel is 16, else in float32.
Bytes encode_openexr(const Image& image, int bits_per_channel);

}  // namespace item3d
