#include "item3d/io/image/tiff.h"

#include "item3d/core/error.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace item3d {
namespace {

struct TiffSource {
    std::span<const std::uint8_t> bytes;
    std::size_t position = 0;
    std::string problem;  ///< first error of libtiff
};

int keep_tiff_problem(TIFF*, void* user, const char*, const char* format, va_list arguments) {
    char text[256];
    std::vsnprintf(text, sizeof text, format, arguments);
    auto& problem = static_cast<TiffSource*>(user)->problem;
    if (problem.empty()) problem = text;
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    return 1;
}

int ignore_tiff_warning(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
}

tmsize_t read_tiff(thandle_t handle, void* data, tmsize_t size) {
    auto& source = *static_cast<TiffSource*>(handle);
    const std::size_t left = source.bytes.size() - source.position;
    const std::size_t count = std::min(left, static_cast<std::size_t>(size));
    if (count > 0) std::memcpy(data, source.bytes.data() + source.position, count);
    source.position += count;
    return static_cast<tmsize_t>(count);
}

tmsize_t write_tiff(thandle_t, void*, tmsize_t) {
    return -1;
}

toff_t seek_tiff(thandle_t handle, toff_t offset, int whence) {
    auto& source = *static_cast<TiffSource*>(handle);
    const toff_t base = whence == SEEK_SET   ? 0
                        : whence == SEEK_CUR ? source.position
                                             : source.bytes.size();
    source.position = std::min<toff_t>(base + offset, source.bytes.size());
    return source.position;
}

int close_tiff(thandle_t) {
    return 0;
}

toff_t size_of_tiff(thandle_t handle) {
    return static_cast<TiffSource*>(handle)->bytes.size();
}

using TiffPointer = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

TiffPointer open_tiff(TiffSource& source) {
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
        TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_tiff_problem, &source);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_tiff_warning, nullptr);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), tmsize_t{1} << 30);
    // "m" disables memory mapping, because the file is already in memory.
    return TiffPointer(TIFFClientOpenExt("TIFF", "rm", &source, read_tiff, write_tiff, seek_tiff,
                                         close_tiff, size_of_tiff, nullptr, nullptr, options.get()),
                       &TIFFClose);
}

std::uint16_t tiff_value(TIFF* tiff, std::uint32_t tag) {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff, tag, &value);
    return value;
}

// True if the file's rows contain the image's values directly. libtiff's own conversion would
// reduce these values to 8 premultiplied bits.
bool has_plain_rows(TIFF* tiff) {
    const std::uint16_t bits = tiff_value(tiff, TIFFTAG_BITSPERSAMPLE);
    const std::uint16_t samples = tiff_value(tiff, TIFFTAG_SAMPLESPERPIXEL);
    std::uint16_t photometric = 0xffff;
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    std::uint16_t extra = 0;
    std::uint16_t* kinds = nullptr;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds);
    const bool is_straight = extra == 0 || (extra == 1 && kinds[0] != EXTRASAMPLE_ASSOCALPHA);
    const bool is_rgb = photometric == PHOTOMETRIC_RGB && samples - extra == 3;
    const bool is_gray = photometric == PHOTOMETRIC_MINISBLACK && samples - extra == 1;
    return (bits == 8 || bits == 16) && is_straight && (is_rgb || is_gray) &&
           tiff_value(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_CONTIG && !TIFFIsTiled(tiff) &&
           tiff_value(tiff, TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_UINT &&
           tiff_value(tiff, TIFFTAG_ORIENTATION) == ORIENTATION_TOPLEFT;
}

bool read_plain_rows(TIFF* tiff, DecodedImage& result) {
    Image& image = result.image;
    const std::size_t values = static_cast<std::size_t>(image.width) * image.channels;
    const bool is_16 = result.bits_per_channel == 16;
    std::vector<std::uint8_t> row(static_cast<std::size_t>(TIFFScanlineSize(tiff)));
    if (row.size() < values * (is_16 ? 2 : 1)) return false;
    for (int y = 0; y < image.height; ++y) {
        if (TIFFReadScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0) != 1) return false;
        float* out = image.pixels.data() + static_cast<std::size_t>(y) * values;
        for (std::size_t i = 0; i < values; ++i) {
            std::uint16_t value = row[i];
            if (is_16) std::memcpy(&value, row.data() + 2 * i, 2);
            out[i] = static_cast<float>(value) / (is_16 ? 65535.0f : 255.0f);
        }
    }
    return true;
}

// Reads images without plain rows by libtiff's own conversion: palettes, tiles, JPEG in TIFF, CMYK,
// and other numbers of bits.
bool read_converted(TIFF* tiff, Image& image) {
    const auto width = static_cast<std::uint32_t>(image.width);
    const auto height = static_cast<std::uint32_t>(image.height);
    std::vector<std::uint32_t> raster(static_cast<std::size_t>(width) * height);
    if (TIFFReadRGBAImageOriented(tiff, width, height, raster.data(), ORIENTATION_TOPLEFT, 1) != 1)
        return false;
    for (std::size_t i = 0; i < raster.size(); ++i) {
        const std::uint32_t pixel = raster[i];
        float* out = image.pixels.data() + i * static_cast<std::size_t>(image.channels);
        const auto alpha = static_cast<float>(TIFFGetA(pixel));
        const float scale = image.channels == 4 && alpha > 0.0f ? 1.0f / alpha : 1.0f / 255.0f;
        out[0] = std::min(1.0f, static_cast<float>(TIFFGetR(pixel)) * scale);
        out[1] = std::min(1.0f, static_cast<float>(TIFFGetG(pixel)) * scale);
        out[2] = std::min(1.0f, static_cast<float>(TIFFGetB(pixel)) * scale);
        if (image.channels == 4) out[3] = alpha / 255.0f;
    }
    return true;
}

}  // namespace

DecodedImage decode_tiff(std::span<const std::uint8_t> bytes, const std::string& subject) {
    TiffSource source{bytes, 0, {}};
    const TiffPointer tiff = open_tiff(source);
    const auto fail = [&](const std::string& otherwise) {
        throw InputError(
            subject,
            "the TIFF cannot be decoded: " + (source.problem.empty() ? otherwise : source.problem),
            "export it again, for example as PNG");
    };
    if (!tiff) fail("its header is damaged");
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
    check_image_size(width, height, 4, bytes.size(), 1ull << 16, subject);
    const bool is_plain = has_plain_rows(tiff.get());
    std::uint16_t extra = 0;
    std::uint16_t* kinds = nullptr;
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_EXTRASAMPLES, &extra, &kinds);
    const int channels =
        is_plain ? tiff_value(tiff.get(), TIFFTAG_SAMPLESPERPIXEL) : (extra > 0 ? 4 : 3);
    DecodedImage result{Image(static_cast<int>(width), static_cast<int>(height), channels), 8, {}};
    if (is_plain) {
        result.bits_per_channel = tiff_value(tiff.get(), TIFFTAG_BITSPERSAMPLE);
        if (!read_plain_rows(tiff.get(), result)) fail("its data are damaged");
    } else {
        char problem[1024] = "";
        if (TIFFRGBAImageOK(tiff.get(), problem) != 1) fail(problem);
        if (!read_converted(tiff.get(), result.image)) fail("its data are damaged");
    }
    return result;
}

}  // namespace item3d
