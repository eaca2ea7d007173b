// OpenEXR pictures. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// `subject` names the picture in errors. Throws InputError.
DecodedImage decode_openexr(std::span<const std::uint8_t> bytes, const std::string& subject);

/// bits_per_channel 16: half, else float; ZIP compressed.
Bytes encode_openexr(const Image& image, int bits_per_channel);

}  // namespace item3d
