// PNG images. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// subject: name of the image in errors and warnings. Throws InputError.
DecodedImage decode_png(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Encodes 1 to 4 channels. bits_per_channel: 8 or 16; values are clamped to [0, 1], NaN becomes 0.
Bytes encode_png(const Image& image, int bits_per_channel);

}  // namespace item3d
