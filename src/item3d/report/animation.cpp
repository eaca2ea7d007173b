#include "item3d/report/animation.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace item3d {

namespace {

struct ImageDeleter {
    void operator()(WebPPicture* image) const {
        WebPPictureFree(image);
        delete image;
    }
};
using ImagePointer = std::unique_ptr<WebPPicture, ImageDeleter>;

struct AnimationDeleter {
    void operator()(WebPAnimEncoder* encoder) const { WebPAnimEncoderDelete(encoder); }
};

void expect(bool success, const char* what) {
    if (!success)
        throw ResourceError(fmt::format("WebP: {} failed, most likely out of memory", what));
}

ImagePointer make_image(const Image& image) {
    ITEM3D_CHECK(image.channels == 3 || image.channels == 4, "WebP holds RGB or RGBA");
    ITEM3D_CHECK(image.width <= WEBP_MAX_DIMENSION && image.height <= WEBP_MAX_DIMENSION,
                 fmt::format("WebP holds at most {} pixels a side", WEBP_MAX_DIMENSION));
    ImagePointer picture(new WebPPicture);
    expect(WebPPictureInit(picture.get()) != 0, "WebPPictureInit");
    picture->use_argb = 1;
    picture->width = image.width;
    picture->height = image.height;
    std::vector<std::uint8_t> bytes(image.pixels.size());
    std::transform(image.pixels.begin(), image.pixels.end(), bytes.begin(), [](float value) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    });
    const int stride = image.width * image.channels;
    expect(image.channels == 4 ? WebPPictureImportRGBA(picture.get(), bytes.data(), stride) != 0
                               : WebPPictureImportRGB(picture.get(), bytes.data(), stride) != 0,
           "WebPPictureImport");
    return picture;
}

WebPConfig make_config(float quality) {
    WebPConfig config;
    expect(WebPConfigInit(&config) != 0, "WebPConfigInit");
    config.lossless = quality >= 100;
    config.quality = config.lossless ? 70 : quality;
    config.method = 3;
    config.alpha_quality = 90;
    return config;
}

}  // namespace

Bytes encode_animation(const std::vector<Image>& frames, const AnimationOptions& options) {
    ITEM3D_CHECK(!frames.empty(), "an animation needs a frame");
    ITEM3D_CHECK(options.frames_per_second > 0, "frames must have a duration above 0");
    WebPAnimEncoderOptions settings;
    expect(WebPAnimEncoderOptionsInit(&settings) != 0, "WebPAnimEncoderOptionsInit");
    settings.anim_params.loop_count = 0;
    // Some viewers show this colour behind transparent pixels instead of the page.
    settings.anim_params.bgcolor = 0x00ffffff;
    const std::unique_ptr<WebPAnimEncoder, AnimationDeleter> encoder(
        WebPAnimEncoderNew(frames.front().width, frames.front().height, &settings));
    expect(encoder != nullptr, "WebPAnimEncoderNew");
    const WebPConfig config = make_config(options.quality);
    const auto time = [&](std::size_t frame) {
        return static_cast<int>(
            std::lround(1000.0 * static_cast<double>(frame) / options.frames_per_second));
    };
    for (std::size_t i = 0; i < frames.size(); ++i) {
        ITEM3D_CHECK(frames[i].width == frames[0].width && frames[i].height == frames[0].height,
                     "all frames must be of one size");
        const ImagePointer image = make_image(frames[i]);
        expect(WebPAnimEncoderAdd(encoder.get(), image.get(), time(i), &config) != 0,
               "WebPAnimEncoderAdd");
    }
    expect(WebPAnimEncoderAdd(encoder.get(), nullptr, time(frames.size()), nullptr) != 0,
           "WebPAnimEncoderAdd");
    WebPData data;
    WebPDataInit(&data);
    expect(WebPAnimEncoderAssemble(encoder.get(), &data) != 0, "WebPAnimEncoderAssemble");
    Bytes bytes(data.bytes, data.bytes + data.size);
    WebPDataClear(&data);
    return bytes;
}

Bytes encode_webp(const Image& image, float quality) {
    const ImagePointer picture = make_image(image);
    const WebPConfig config = make_config(quality);
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture->writer = WebPMemoryWrite;
    picture->custom_ptr = &writer;
    const bool encoded = WebPEncode(&config, picture.get()) != 0;
    Bytes bytes;
    if (encoded) bytes.assign(writer.mem, writer.mem + writer.size);
    WebPMemoryWriterClear(&writer);
    expect(encoded, "WebPEncode");
    return bytes;
}

}  // namespace item3d
