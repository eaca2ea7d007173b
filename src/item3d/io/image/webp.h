// WebP pictures. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// The first picture of an animation. `subject` names the picture in errors and warnings. Throws
/// InputError.
DecodedImage decode_webp(std::span<const std::uint8_t> bytes, const std::string& subject);

/// The longest edge that a WebP can have.
inline constexpr int largest_webp_edge = 16383;

/// 8 bits; 1 to 4 channels (grey becomes RGB), edges up to largest_webp_edge; values are clamped to
/// [0, 1], NaN is 0. is_lossless keeps the colours of transparent pixels too. quality: 1 to 100, of
/// a picture with losses.
Bytes encode_webp_texture(const Image& image, bool is_lossless, int quality);

}  // namespace item3d
