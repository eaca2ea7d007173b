#include "item3d/io/image/webp.h"

#include "item3d/core/error.h"

#include <webp/decode.h>
#include <webp/demux.h>
#include <webp/encode.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace item3d {
namespace {

const char* webp_problem(VP8StatusCode status) {
    switch (status) {
        case VP8_STATUS_OUT_OF_MEMORY:
            return "out of memory";
        case VP8_STATUS_NOT_ENOUGH_DATA:
        case VP8_STATUS_SUSPENDED:
            return "it ends too early";
        case VP8_STATUS_UNSUPPORTED_FEATURE:
            return "it uses an unknown feature";
        default:
            return "its data are damaged";
    }
}

[[noreturn]] void throw_webp_error(VP8StatusCode status, const std::string& subject) {
    throw InputError(subject, std::string("the WebP cannot be decoded: ") + webp_problem(status),
                     "export it again");
}

// Returns the image data of an animation's first frame; `bytes` itself for a still image.
std::span<const std::uint8_t> first_frame(std::span<const std::uint8_t> bytes,
                                          const WebPBitstreamFeatures& features,
                                          const std::string& subject) {
    if (!features.has_animation) return bytes;
    const WebPData data{bytes.data(), bytes.size()};
    const std::unique_ptr<WebPDemuxer, decltype(&WebPDemuxDelete)> demuxer(WebPDemux(&data),
                                                                           &WebPDemuxDelete);
    WebPIterator frame;
    if (!demuxer || !WebPDemuxGetFrame(demuxer.get(), 1, &frame))
        throw_webp_error(VP8_STATUS_BITSTREAM_ERROR, subject);
    const std::span<const std::uint8_t> payload(frame.fragment.bytes, frame.fragment.size);
    WebPDemuxReleaseIterator(&frame);
    return payload;
}

std::vector<std::uint8_t> to_rgba8(const Image& image) {
    const auto byte = [](float value) {
        const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
        return static_cast<std::uint8_t>(std::lround(clamped * 255.0f));
    };
    const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
    std::vector<std::uint8_t> result(4 * count, 255);
    for (std::size_t i = 0; i < count; ++i) {
        const float* pixel = image.pixels.data() + i * static_cast<std::size_t>(image.channels);
        for (int c = 0; c < 3; ++c)
            result[4 * i + c] = byte(pixel[image.channels >= 3 ? c : 0]);
        if (image.channels % 2 == 0) result[4 * i + 3] = byte(pixel[image.channels - 1]);
    }
    return result;
}

}  // namespace

DecodedImage decode_webp(std::span<const std::uint8_t> bytes, const std::string& subject) {
    WebPBitstreamFeatures features;
    VP8StatusCode status = WebPGetFeatures(bytes.data(), bytes.size(), &features);
    if (status != VP8_STATUS_OK) throw_webp_error(status, subject);
    const std::span<const std::uint8_t> frame = first_frame(bytes, features, subject);
    if (features.has_animation) {
        status = WebPGetFeatures(frame.data(), frame.size(), &features);
        if (status != VP8_STATUS_OK) throw_webp_error(status, subject);
    }
    const int channels = features.has_alpha ? 4 : 3;
    // The limit is high, because four bytes can encode an image of one colour and of any size.
    check_image_size(static_cast<std::uint64_t>(features.width),
                     static_cast<std::uint64_t>(features.height),
                     static_cast<std::uint64_t>(channels), frame.size(), 1ull << 28, subject);
    // The memory stays untouched until the data are known to be complete, because a header may
    // claim any size.
    const std::size_t size = static_cast<std::size_t>(features.width) *
                             static_cast<std::size_t>(features.height) *
                             static_cast<std::size_t>(channels);
    const auto raw = std::make_unique_for_overwrite<std::uint8_t[]>(size);
    WebPDecoderConfig config;
    WebPInitDecoderConfig(&config);
    config.output.colorspace = channels == 4 ? MODE_RGBA : MODE_RGB;
    config.output.is_external_memory = 1;
    config.output.u.RGBA = {raw.get(), features.width * channels, size};
    status = WebPDecode(frame.data(), frame.size(), &config);
    if (status != VP8_STATUS_OK) throw_webp_error(status, subject);
    DecodedImage result{Image(features.width, features.height, channels), 8, {}};
    // The format is 1 for lossy and 2 for lossless images.
    result.coding = {ImageEncoding::webp, features.format == 2, 95};
    std::transform(raw.get(), raw.get() + size, result.image.pixels.begin(),
                   [](std::uint8_t value) { return static_cast<float>(value) / 255.0f; });
    return result;
}

Bytes encode_webp_texture(const Image& image, bool is_lossless, int quality) {
    ITEM3D_CHECK(image.width > 0 && image.height > 0 && image.channels >= 1,
                 "an empty image cannot be written");
    ITEM3D_CHECK(std::max(image.width, image.height) <= largest_webp_edge,
                 "a WebP has at most 16383 pixels per side");
    WebPConfig config;
    WebPPicture picture;
    WebPConfigInit(&config);
    WebPPictureInit(&picture);
    if (is_lossless) {
        WebPConfigLosslessPreset(&config, 6);
        config.exact = 1;
    } else {
        config.quality = static_cast<float>(quality);
        config.use_sharp_yuv = 1;
    }
    picture.use_argb = 1;
    picture.width = image.width;
    picture.height = image.height;
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    const std::vector<std::uint8_t> rgba = to_rgba8(image);
    const bool is_encoded =
        (image.channels % 2 == 0 ? WebPPictureImportRGBA(&picture, rgba.data(), 4 * image.width)
                                 : WebPPictureImportRGBX(&picture, rgba.data(), 4 * image.width)) &&
        WebPEncode(&config, &picture);
    WebPPictureFree(&picture);
    Bytes bytes;
    if (is_encoded) bytes.assign(writer.mem, writer.mem + writer.size);
    WebPMemoryWriterClear(&writer);
    if (!is_encoded) throw ResourceError("a WebP could not be encoded: out of memory");
    return bytes;
}

}  // namespace item3d
