// PNG by libpng, which reports errors by longjmp, so the functions between setjmp and libpng hold
// nothing that needs a destructor.
#include "item3d/io/image/png.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

namespace item3d {
namespace {

struct PngReader {
    const std::uint8_t* bytes = nullptr;
    std::size_t size = 0;
    std::size_t offset = 0;
    png_structp png = nullptr;
    png_infop info = nullptr;
    char problem[160] = "";
    char crc_warning[160] = "";

    PngReader() = default;
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_read_error(png_structp png, png_const_charp message) {
    auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader->problem, sizeof reader->problem, "%s", message);
    png_longjmp(png, 1);
}

void on_read_warning(png_structp png, png_const_charp message) {
    auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
    if (std::strstr(message, "CRC")) {
        std::snprintf(reader->crc_warning, sizeof reader->crc_warning, "%s", message);
    }
}

void read_from_memory(png_structp png, png_bytep out, png_size_t count) {
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->size - reader->offset) png_error(png, "the file ends too early");
    std::memcpy(out, reader->bytes + reader->offset, count);
    reader->offset += count;
}

bool read_header(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_set_read_fn(reader.png, &reader, read_from_memory);
    // An image with a wrong checksum may be usable: warn and continue.
    png_set_crc_action(reader.png, PNG_CRC_WARN_USE, PNG_CRC_WARN_DISCARD);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);  // palettes to RGB, 1, 2, 4 bits to 8, tRNS to alpha
    png_set_swap(reader.png);    // 16 bits to little endian
    png_set_interlace_handling(reader.png);
    return true;
}

bool update_info(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_update_info(reader.png, reader.info);
    return true;
}

bool read_rows(PngReader& reader, png_bytep pixels, std::size_t row_bytes, png_uint_32 height) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    const int passes =
        png_get_interlace_type(reader.png, reader.info) == PNG_INTERLACE_ADAM7 ? 7 : 1;
    for (int pass = 0; pass < passes; ++pass) {
        for (png_uint_32 y = 0; y < height; ++y) {
            png_read_row(reader.png, pixels + y * row_bytes, nullptr);
        }
    }
    return true;
}

[[noreturn]] void throw_png_error(const PngReader& reader, const std::string& subject) {
    throw InputError(subject, std::string("the PNG cannot be decoded: ") + reader.problem,
                     "export it again");
}

struct PngWriter {
    Bytes bytes;
    png_structp png = nullptr;
    png_infop info = nullptr;

    PngWriter() = default;
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

void on_write_error(png_structp png, png_const_charp) {
    png_longjmp(png, 1);
}
void on_write_warning(png_structp, png_const_charp) {}

void write_to_memory(png_structp png, png_bytep data, png_size_t count) {
    auto* writer = static_cast<PngWriter*>(png_get_io_ptr(png));
    writer->bytes.insert(writer->bytes.end(), data, data + count);
}

bool write_rows(PngWriter& writer, const std::uint8_t* pixels, std::size_t row_bytes, int width,
                int height, int bits, int color_type) {
    if (setjmp(png_jmpbuf(writer.png))) return false;
    png_set_write_fn(writer.png, &writer, write_to_memory, nullptr);
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width),
                 static_cast<png_uint_32>(height), bits, color_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(writer.png, 6);
    png_write_info(writer.png, writer.info);
    for (int y = 0; y < height; ++y) {
        png_write_row(writer.png, pixels + static_cast<std::size_t>(y) * row_bytes);
    }
    png_write_end(writer.png, nullptr);
    return true;
}

}  // namespace

DecodedImage decode_png(std::span<const std::uint8_t> bytes, const std::string& subject) {
    PngReader reader;
    reader.bytes = bytes.data();
    reader.size = bytes.size();
    reader.png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_read_error, on_read_warning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info) throw ResourceError(subject + ": out of memory");
    if (!read_header(reader)) throw_png_error(reader, subject);

    const auto width = png_get_image_width(reader.png, reader.info);
    const auto height = png_get_image_height(reader.png, reader.info);
    // The limit follows from deflate, which expands data by at most 1032, and from pixels of at
    // least one bit.
    check_image_size(width, height, 4, bytes.size(), 1032 * 8, subject);
    if (!update_info(reader)) throw_png_error(reader, subject);
    const int channels = png_get_channels(reader.png, reader.info);
    const int bits = png_get_bit_depth(reader.png, reader.info);
    const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);

    Bytes raw(row_bytes * height);
    if (!read_rows(reader, raw.data(), row_bytes, height)) throw_png_error(reader, subject);
    if (reader.crc_warning[0]) {
        warn(subject + ": the PNG has a wrong checksum and is used anyway (" + reader.crc_warning +
             ")");
    }

    DecodedImage result{Image(static_cast<int>(width), static_cast<int>(height), channels),
                        bits == 16 ? 16 : 8};
    std::vector<float>& pixels = result.image.pixels;
    if (bits == 16) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            std::uint16_t value;
            std::memcpy(&value, raw.data() + 2 * i, 2);
            pixels[i] = static_cast<float>(value) / 65535.0f;
        }
    } else {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            pixels[i] = static_cast<float>(raw[i]) / 255.0f;
        }
    }
    return result;
}

Bytes encode_png(const Image& image, int bits_per_channel) {
    ITEM3D_CHECK(image.channels >= 1 && image.channels <= 4,
                 "a PNG has 1 to 4 channels, not " + std::to_string(image.channels));
    ITEM3D_CHECK(image.width > 0 && image.height > 0, "an empty image cannot be written");
    const int bits = bits_per_channel > 8 ? 16 : 8;
    const float scale = bits == 16 ? 65535.0f : 255.0f;
    const std::size_t row_values = static_cast<std::size_t>(image.width) * image.channels;
    const std::size_t row_bytes = row_values * (bits / 8);
    Bytes raw(row_bytes * image.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float value = image.pixels[i];
        // The comparison is false for NaN, which becomes 0.
        const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
        const auto integer = static_cast<unsigned>(std::lround(clamped * scale));
        if (bits == 16) {
            raw[2 * i] = static_cast<std::uint8_t>(integer >> 8);
            raw[2 * i + 1] = static_cast<std::uint8_t>(integer & 255);
        } else {
            raw[i] = static_cast<std::uint8_t>(integer);
        }
    }
    constexpr int color_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                   PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    PngWriter writer;
    writer.png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_write_error, on_write_warning);
    writer.info = writer.png ? png_create_info_struct(writer.png) : nullptr;
    if (!writer.info || !write_rows(writer, raw.data(), row_bytes, image.width, image.height, bits,
                                    color_types[image.channels - 1])) {
        throw ResourceError("a PNG could not be encoded: out of memory");
    }
    return std::move(writer.bytes);
}

}  // namespace item3d
