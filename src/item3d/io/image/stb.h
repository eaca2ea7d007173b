// BMP, TGA and GIF pictures, by stb_image. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// Whether the bytes begin with a header of TGA, which has no magic number.
bool looks_like_tga(std::span<const std::uint8_t> bytes);

/// Of a GIF the first picture. `format` ("BMP") and `subject` are for errors. Throws InputError.
DecodedImage decode_with_stb(std::span<const std::uint8_t> bytes, const std::string& format,
                             const std::string& subject);

}  // namespace item3d
