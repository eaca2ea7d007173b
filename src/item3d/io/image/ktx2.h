// KTX2 pictures of Basis Universal: ETC1S and UASTC, as KHR_texture_basisu has them. Internal to
// io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// The largest level of the first layer and face, Zstandard taken off. `subject` names the picture
/// in errors. Throws InputError.
DecodedImage decode_ktx2(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
