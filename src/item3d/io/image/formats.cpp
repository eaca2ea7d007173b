#include "item3d/io/image/formats.h"

#include "item3d/core/error.h"

#include <fmt/format.h>

#include <cstring>

namespace item3d {
namespace {

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

ImageFormat detect_image_format(std::span<const std::uint8_t> bytes) {
    using namespace std::string_view_literals;
    if (starts_with(bytes, "\x89PNG\r\n\x1a\n"sv)) return ImageFormat::png;
    if (starts_with(bytes, "\xff\xd8\xff"sv)) return ImageFormat::jpeg;
    if (starts_with(bytes, "#?RADIANCE"sv) || starts_with(bytes, "#?RGBE"sv)) {
        return ImageFormat::radiance;
    }
    if (starts_with(bytes, "\x76\x2f\x31\x01"sv)) return ImageFormat::openexr;
    return ImageFormat::unknown;
}

DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject) {
    switch (detect_image_format(bytes)) {
        case ImageFormat::png:
            return decode_png(bytes, subject);
        case ImageFormat::jpeg:
            return decode_jpeg(bytes, subject);
        case ImageFormat::radiance:
            return decode_radiance(bytes, subject);
        case ImageFormat::openexr:
            return decode_openexr(bytes, subject);
        case ImageFormat::unknown:
            break;
    }
    throw InputError(subject,
                     bytes.empty() ? "an image was expected, the file is empty"
                                   : "an image was expected, found an unknown format",
                     "use PNG, JPEG, Radiance HDR or OpenEXR");
}

void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                      std::uint64_t available, std::uint64_t most_pixels_per_byte,
                      const std::string& subject) {
    constexpr std::uint64_t most_values = 1ull << 28;
    if (width == 0 || height == 0 || channels == 0) {
        throw InputError(subject, fmt::format("declares {} x {} pixels", width, height));
    }
    if (width > most_values || height > most_values || width * height > most_values / channels) {
        throw InputError(
            subject, fmt::format("declares {} x {} pixels, more than can be used", width, height),
            "scale it down");
    }
    if (width * height > (available + 64) * most_pixels_per_byte) {
        throw InputError(subject,
                         fmt::format("declares {} x {} pixels, but {} bytes cannot hold them",
                                     width, height, available),
                         "the file is damaged");
    }
}

}  // namespace item3d
