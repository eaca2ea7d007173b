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

/// Returns the MIME type, such as "image/png"; nullptr if the format has none.
const char* mime_type(ImageFormat format);

/// Decodes an image in any of these formats, detected by content. subject: name of the image in
/// errors and warnings. Throws InputError.
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Decodes an image to a texture without a name. The texture keeps `bytes` if a glTF can embed them
/// unchanged.
Texture decode_texture(Bytes bytes, const std::string& subject);

}  // namespace item3d
