// Radiance HDR pictures. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// `subject` names the picture in errors. Throws InputError.
DecodedImage decode_radiance(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Run-length coded RGBE; an alpha channel is dropped, one channel becomes three.
Bytes encode_radiance(const Image& image);

}  // namespace item3d
