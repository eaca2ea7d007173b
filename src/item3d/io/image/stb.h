// BMP, TGA and GIF images, decoded by stb_image. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// True if the bytes begin with a plausible header of TGA, which has no magic number.
bool looks_like_tga(std::span<const std::uint8_t> bytes);

/// Decodes an image; from a GIF, its first image. format ("BMP") and subject are names for error
/// messages. Throws InputError.
DecodedImage decode_with_stb(std::span<const std::uint8_t> bytes, const std::string& format,
                             const std::string& subject);

}  // namespace item3d
