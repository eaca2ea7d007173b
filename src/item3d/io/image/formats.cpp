#include "item3d/io/image/formats.h"

#include "item3d/core/error.h"
#include "item3d/io/image/jpeg.h"
#include "item3d/io/image/openexr.h"
#include "item3d/io/image/png.h"
#include "item3d/io/image/radiance.h"

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

}  // namespace item3d
