// KTX2 images of Basis Universal: ETC1S and UASTC, as in KHR_texture_basisu. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// Decodes the largest mip level of the first layer and face. The level may be compressed with
/// Zstandard. subject: name of the image in errors. Throws InputError.
DecodedImage decode_ktx2(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
