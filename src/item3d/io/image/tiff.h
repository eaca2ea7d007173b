// TIFF pictures. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// The first picture, in 8 bits, or in 16 where it is grey or RGB in rows. `subject` names the
/// picture in errors. Throws InputError.
DecodedImage decode_tiff(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
