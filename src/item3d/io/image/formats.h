// The picture formats, told apart by content. Internal to io.
#pragma once

#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

enum class ImageFormat { unknown, png, jpeg, radiance, openexr };

/// By the first bytes of the file.
ImageFormat detect_image_format(std::span<const std::uint8_t> bytes);

/// Decodes by content. `subject` names the picture in errors and warnings. Throws InputError.
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace item3d
