// Picture formats, each between bytes in memory and an Image. Internal to scene/io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

#include <cstdint>
#include <span>
#include <string>

namespace item3d {

enum class ImageFormat { unknown, png, jpeg, radiance, openexr };

/// By the first bytes of the file.
ImageFormat detect_image_format(std::span<const std::uint8_t> bytes);

struct DecodedImage {
    Image image;
    int bits_per_channel = 8;  ///< 8, 16 or 32
};

/// Decodes by content. `subject` names the picture in errors and warnings. Throws InputError.
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject);

DecodedImage decode_png(std::span<const std::uint8_t> bytes, const std::string& subject);
DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& subject);
DecodedImage decode_radiance(std::span<const std::uint8_t> bytes, const std::string& subject);
DecodedImage decode_openexr(std::span<const std::uint8_t> bytes, const std::string& subject);

/// bits_per_channel 8 or 16; 1 to 4 channels; values are clamped to [0, 1], NaN is 0.
Bytes encode_png(const Image& image, int bits_per_channel);
/// 4:4:4, quality 95; an alpha channel is dropped.
Bytes encode_jpeg(const Image& image);
/// Run-length coded RGBE; an alpha channel is dropped, one channel becomes three.
Bytes encode_radiance(const Image& image);
/// bits_per_channel 16: half, else float; ZIP compressed.
Bytes encode_openexr(const Image& image, int bits_per_channel);

/// Refuses pictures that are too large (2^28 values) or that `available` bytes cannot hold even
/// when every byte stands for `most_pixels_per_byte` pixels, before anything is allocated.
void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                      std::uint64_t available, std::uint64_t most_pixels_per_byte,
                      const std::string& subject);

}  // namespace item3d
