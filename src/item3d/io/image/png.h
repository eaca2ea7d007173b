// PNG pictures. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// `subject` names the picture in errors and warnings. Throws InputError.
DecodedImage decode_png(std::span<const std::uint8_t> bytes, const std::string& subject);

/// bits_per_channel 8 or 16; 1 to 4 channels; values are clamped to [0, 1], NaN is 0.
Bytes encode_png(const Image& image, int bits_per_channel);

}  // namespace item3d
