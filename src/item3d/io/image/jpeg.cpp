// JPEG by libjpeg(-turbo), which reports errors by a call that must not return, here by longjmp.
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
// jpeglib.h needs stdio first.
#include <jpeglib.h>
// jerror.h needs jpeglib.h first.
#include "item3d/core/error.h"
#include "item3d/io/image/jpeg.h"

#include <jerror.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

struct JpegErrors {
    jpeg_error_mgr base;
    std::jmp_buf target;
    char problem[JMSG_LENGTH_MAX];
};

void on_error(j_common_ptr codec) {
    auto* errors = reinterpret_cast<JpegErrors*>(codec->err);
    codec->err->format_message(codec, errors->problem);
    std::longjmp(errors->target, 1);
}

// Treats data that ends early or runs into a marker as an error, and ignores other irregularities.
void on_message(j_common_ptr codec, int level) {
    if (level >= 0) return;
    const int code = codec->err->msg_code;
    if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER) on_error(codec);
}

// Limits the number of scans: a small progressive file can request thousands of scans of a large
// image.
void on_progress(j_common_ptr codec) {
    if (codec->is_decompressor &&
        reinterpret_cast<j_decompress_ptr>(codec)->input_scan_number > 200) {
        codec->err->msg_code = JERR_BAD_PROGRESSION;
        on_error(codec);
    }
}

struct JpegReader {
    jpeg_decompress_struct codec{};
    JpegErrors errors{};
    jpeg_progress_mgr progress{};
    bool created = false;

    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() {
        if (created) jpeg_destroy_decompress(&codec);
    }
};

bool read_header(JpegReader& reader, const std::uint8_t* bytes, std::size_t size) {
    reader.codec.err = jpeg_std_error(&reader.errors.base);
    reader.errors.base.error_exit = on_error;
    reader.errors.base.emit_message = on_message;
    if (setjmp(reader.errors.target)) return false;
    jpeg_create_decompress(&reader.codec);
    reader.created = true;
    reader.progress.progress_monitor = on_progress;
    reader.codec.progress = &reader.progress;
    jpeg_mem_src(&reader.codec, bytes, size);
    jpeg_read_header(&reader.codec, TRUE);
    switch (reader.codec.jpeg_color_space) {
        case JCS_GRAYSCALE:
            reader.codec.out_color_space = JCS_GRAYSCALE;
            break;
        case JCS_CMYK:
        case JCS_YCCK:
            reader.codec.out_color_space = JCS_CMYK;
            break;
        default:
            reader.codec.out_color_space = JCS_RGB;
            break;
    }
    return true;
}

bool read_rows(JpegReader& reader, std::uint8_t* pixels, std::size_t row_bytes) {
    if (setjmp(reader.errors.target)) return false;
    jpeg_start_decompress(&reader.codec);
    while (reader.codec.output_scanline < reader.codec.output_height) {
        JSAMPROW row = pixels + reader.codec.output_scanline * row_bytes;
        jpeg_read_scanlines(&reader.codec, &row, 1);
    }
    jpeg_finish_decompress(&reader.codec);
    return true;
}

[[noreturn]] void throw_jpeg_error(const JpegReader& reader, const std::string& subject) {
    throw InputError(subject, std::string("the JPEG cannot be decoded: ") + reader.errors.problem,
                     "export it again");
}

struct JpegWriter {
    jpeg_compress_struct codec{};
    JpegErrors errors{};
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    bool created = false;

    JpegWriter() = default;
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() {
        if (created) jpeg_destroy_compress(&codec);
        std::free(bytes);
    }
};

bool write_rows(JpegWriter& writer, std::uint8_t* pixels, int width, int height, int channels,
                int quality) {
    writer.codec.err = jpeg_std_error(&writer.errors.base);
    writer.errors.base.error_exit = on_error;
    if (setjmp(writer.errors.target)) return false;
    jpeg_create_compress(&writer.codec);
    writer.created = true;
    jpeg_mem_dest(&writer.codec, &writer.bytes, &writer.size);
    writer.codec.image_width = static_cast<JDIMENSION>(width);
    writer.codec.image_height = static_cast<JDIMENSION>(height);
    writer.codec.input_components = channels;
    writer.codec.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&writer.codec);
    jpeg_set_quality(&writer.codec, quality, TRUE);
    writer.codec.optimize_coding = TRUE;
    writer.codec.comp_info[0].h_samp_factor = 1;
    writer.codec.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&writer.codec, TRUE);
    while (writer.codec.next_scanline < writer.codec.image_height) {
        JSAMPROW row =
            pixels + static_cast<std::size_t>(writer.codec.next_scanline) * width * channels;
        jpeg_write_scanlines(&writer.codec, &row, 1);
    }
    jpeg_finish_compress(&writer.codec);
    return true;
}

// Returns the quality at which re-encoding a changed image adds little error. The squared error of
// quantisation grows with the square of the step. New steps of 0.35 times the old steps therefore
// add an eighth to the squared error, which is half a decibel.
int quality_for_changes(const jpeg_decompress_struct& codec) {
    constexpr double luminance_sum = 3688;  // sum of the luminance table of quality 50
    const JQUANT_TBL* table = codec.quant_tbl_ptrs[0];
    if (!table) return 95;
    double sum = 0;
    for (const UINT16 step : table->quantval)
        sum += step;
    const double scale = 0.35 * 100 * sum / luminance_sum;
    const double quality = scale <= 100 ? (200 - scale) / 2 : 5000 / scale;
    return static_cast<int>(std::lround(std::clamp(quality, 80.0, 98.0)));
}

}  // namespace

DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& subject) {
    JpegReader reader;
    if (!read_header(reader, bytes.data(), bytes.size())) throw_jpeg_error(reader, subject);
    const int width = static_cast<int>(reader.codec.image_width);
    const int height = static_cast<int>(reader.codec.image_height);
    // The limit follows from blocks of 8 x 8 pixels, each of which needs at least one bit.
    check_image_size(reader.codec.image_width, reader.codec.image_height, 3, bytes.size(), 8 * 64,
                     subject);
    const bool is_cmyk = reader.codec.out_color_space == JCS_CMYK;
    const int stored = is_cmyk ? 4 : reader.codec.out_color_space == JCS_GRAYSCALE ? 1 : 3;
    const std::size_t row_bytes = static_cast<std::size_t>(width) * stored;
    Bytes raw(row_bytes * height);
    if (!read_rows(reader, raw.data(), row_bytes)) throw_jpeg_error(reader, subject);

    DecodedImage result{Image(width, height, is_cmyk ? 3 : stored), 8, {}};
    result.coding = {ImageEncoding::jpeg, false, quality_for_changes(reader.codec)};
    if (!is_cmyk) {
        std::transform(raw.begin(), raw.end(), result.image.pixels.begin(),
                       [](std::uint8_t value) { return static_cast<float>(value) / 255.0f; });
        return result;
    }
    const bool inverted = reader.codec.saw_Adobe_marker;
    for (std::size_t i = 0; i < raw.size() / 4; ++i) {
        const auto ink = [&](int c) {
            const float value = static_cast<float>(raw[4 * i + c]) / 255.0f;
            return inverted ? value : 1.0f - value;
        };
        for (int c = 0; c < 3; ++c)
            result.image.pixels[3 * i + c] = ink(c) * ink(3);
    }
    return result;
}

Bytes encode_jpeg(const Image& image, int quality) {
    ITEM3D_CHECK(image.width > 0 && image.height > 0 && image.channels >= 1,
                 "an empty image cannot be written");
    const int channels = image.channels < 3 ? 1 : 3;
    const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
    Bytes raw(count * channels);
    for (std::size_t i = 0; i < count; ++i) {
        for (int c = 0; c < channels; ++c) {
            const float value = image.pixels[i * image.channels + c];
            const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
            raw[i * channels + c] = static_cast<std::uint8_t>(std::lround(clamped * 255.0f));
        }
    }
    JpegWriter writer;
    if (!write_rows(writer, raw.data(), image.width, image.height, channels, quality)) {
        throw InputError("JPEG",
                         std::string("the image could not be encoded: ") + writer.errors.problem,
                         "use .png");
    }
    return Bytes(writer.bytes, writer.bytes + writer.size);
}

}  // namespace item3d
