#include "item3d/io/image/formats.h"

#include "item3d/core/error.h"
#include "item3d/io/image/foreign.h"
#include "item3d/io/image/jpeg.h"
#include "item3d/io/image/ktx2.h"
#include "item3d/io/image/openexr.h"
#include "item3d/io/image/png.h"
#include "item3d/io/image/radiance.h"
#include "item3d/io/image/stb.h"
#include "item3d/io/image/tiff.h"
#include "item3d/io/image/webp.h"

#include <algorithm>
#include <cstring>
#include <memory>

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
    if (starts_with(bytes, "RIFF"sv) && bytes.size() >= 12 &&
        starts_with(bytes.subspan(8), "WEBP"sv))
        return ImageFormat::webp;
    if (starts_with(bytes, "\xabKTX 20\xbb\r\n\x1a\n"sv)) return ImageFormat::ktx2;
    if (starts_with(bytes, "GIF87a"sv) || starts_with(bytes, "GIF89a"sv)) return ImageFormat::gif;
    if (starts_with(bytes, "II*\0"sv) || starts_with(bytes, "MM\0*"sv) ||
        starts_with(bytes, "II+\0"sv) || starts_with(bytes, "MM\0+"sv))
        return ImageFormat::tiff;
    if (starts_with(bytes, "BM"sv)) return ImageFormat::bmp;
    if (!foreign_format(bytes) && looks_like_tga(bytes)) return ImageFormat::tga;
    return ImageFormat::unknown;
}

const char* mime_type(ImageFormat format) {
    switch (format) {
        case ImageFormat::png:
            return "image/png";
        case ImageFormat::jpeg:
            return "image/jpeg";
        case ImageFormat::webp:
            return "image/webp";
        case ImageFormat::ktx2:
            return "image/ktx2";
        case ImageFormat::bmp:
            return "image/bmp";
        case ImageFormat::tga:
            return "image/x-tga";
        case ImageFormat::gif:
            return "image/gif";
        case ImageFormat::tiff:
            return "image/tiff";
        default:
            return nullptr;
    }
}

DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& subject) {
    switch (detect_image_format(bytes)) {
        case ImageFormat::png:
            return decode_png(bytes, subject);
        case ImageFormat::jpeg:
            return decode_jpeg(bytes, subject);
        case ImageFormat::webp:
            return decode_webp(bytes, subject);
        case ImageFormat::ktx2:
            return decode_ktx2(bytes, subject);
        case ImageFormat::bmp:
            return decode_with_stb(bytes, "BMP", subject);
        case ImageFormat::tga:
            return decode_with_stb(bytes, "TGA", subject);
        case ImageFormat::gif:
            return decode_with_stb(bytes, "GIF", subject);
        case ImageFormat::tiff:
            return decode_tiff(bytes, subject);
        case ImageFormat::radiance:
            return decode_radiance(bytes, subject);
        case ImageFormat::openexr:
            return decode_openexr(bytes, subject);
        case ImageFormat::unknown:
            break;
    }
    if (bytes.empty())
        throw InputError(subject, "expected an image, but the file is empty",
                         "export the image again");
    const char* foreign = foreign_format(bytes);
    throw InputError(
        subject,
        foreign ? std::string("expected an image, found ") + foreign + ", which is not supported"
                : "expected an image, found an unknown format",
        "use PNG, JPEG, WebP or KTX2 (lights: Radiance HDR or OpenEXR)");
}

Texture decode_texture(Bytes bytes, const std::string& subject) {
    const ImageFormat format = detect_image_format(bytes);
    DecodedImage decoded = decode_image(bytes, subject);
    Texture texture;
    texture.image = std::move(decoded.image);
    texture.bits_per_channel = std::min(decoded.bits_per_channel, 16);
    texture.coding = decoded.coding;
    if (format == ImageFormat::png || format == ImageFormat::jpeg || format == ImageFormat::webp)
        texture.file = std::make_shared<const Bytes>(std::move(bytes));
    return texture;
}

}  // namespace item3d
