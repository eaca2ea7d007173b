// TIFF images. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// Decodes the first image of the file. The result has 16 bits per channel if the file has 16-bit
/// grey or RGB values in strips, else 8. subject: name of the image in errors. Throws InputError.
DecodedImage decode_tiff(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
