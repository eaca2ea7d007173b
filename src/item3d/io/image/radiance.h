// Radiance HDR images. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// subject: name of the image in errors. Throws InputError.
DecodedImage decode_radiance(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Encodes run-length coded RGBE; drops an alpha channel and repeats a single channel three times.
Bytes encode_radiance(const Image& image);

}  // namespace item3d
