// JPEG images. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// subject: name of the image in errors. Throws InputError.
DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Encodes without chroma subsampling (4:4:4); drops an alpha channel.
Bytes encode_jpeg(const Image& image, int quality = 95);

}  // namespace item3d
