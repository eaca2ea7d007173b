// TIFF images. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// Decodes the first image, to 8 bits, or to 16 where it is grey or RGB in strips. subject: name of
/// the image in errors. Throws InputError.
DecodedImage decode_tiff(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
