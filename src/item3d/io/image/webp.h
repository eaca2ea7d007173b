// WebP images. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/image/decoded_image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

/// Decodes the first image of an animation. subject: name of the image in errors and warnings.
/// Throws InputError.
DecodedImage decode_webp(std::span<const std::uint8_t> bytes, const std::string& subject);

/// Longest edge of a WebP.
inline constexpr int largest_webp_edge = 16383;

/// Encodes 1 to 4 channels in 8 bits each; grey becomes RGB. No edge may exceed largest_webp_edge.
/// Values are clamped to [0, 1], NaN becomes 0. A lossless file also keeps the colours of
/// transparent pixels. quality: 1 to 100, for lossy images.
Bytes encode_webp_texture(const Image& image, bool is_lossless, int quality);

}  // namespace item3d
