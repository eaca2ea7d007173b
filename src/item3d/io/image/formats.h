// Image formats, detected by content. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

enum class ImageFormat { unknown, png, jpeg, webp, ktx2, bmp, tga, gif, tiff, radiance, openexr };

/// Detects the format by the first bytes of the file.
ImageFormat detect_image_format(std::span<const std::uint8_t> bytes);

/// Returns "image/png" and the like; nullptr where there is none.
const char* mime_type(ImageFormat format);

/// Decodes by content. subject: name of the image in errors and warnings. Throws InputError.
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Decodes to a texture without a name, which keeps `bytes` if they can be embedded unchanged.
Texture decode_texture(Bytes bytes, const std::string& subject);

}  // namespace item3d
