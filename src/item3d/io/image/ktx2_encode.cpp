#include "item3d/io/image/ktx2_encode.h"

#include "item3d/core/error.h"
#include "item3d/core/module.h"
#include "item3d/io/image/ktx2_module.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <thread>

namespace item3d {
namespace {

Ktx2Encode* find_encoder() {
    static const Module module = open_module("libitem3d_ktx2.so", "make");
    if (module.handle == nullptr)
        throw ResourceError("cannot write KTX2: " + module.problem +
                            "; use --texture-format jpeg or webp");
    auto* encode = reinterpret_cast<Ktx2Encode*>(dlsym(module.handle, ktx2_encode_name));
    if (encode == nullptr)
        throw ResourceError("cannot write KTX2: libitem3d_ktx2.so has a different version");
    return encode;
}

}  // namespace

bool fits_ktx2(const Image& image) {
    return image.width % 4 == 0 && image.height % 4 == 0 && image.width > 0 && image.height > 0;
}

Bytes encode_ktx2(const Image& image, bool is_srgb, bool is_precise, int quality) {
    ITEM3D_CHECK(fits_ktx2(image), "edge lengths must be multiples of four");
    const auto count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    const auto channels = static_cast<std::size_t>(image.channels);
    const bool has_alpha = channels % 2 == 0;
    Bytes rgba(4 * count, 255);
    const auto to_byte = [](float value) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    };
    for (std::size_t i = 0; i < count; ++i) {
        const float* pixel = image.pixels.data() + i * channels;
        for (std::size_t c = 0; c < 3; ++c)
            rgba[4 * i + c] = to_byte(pixel[channels >= 3 ? c : 0]);
        if (has_alpha) rgba[4 * i + 3] = to_byte(pixel[channels - 1]);
    }
    const auto threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    Bytes file;
    if (!find_encoder()({rgba.data(), image.width, image.height, has_alpha, is_srgb, is_precise,
                         quality, threads},
                        file))
        throw ResourceError("the encoder of KTX2 failed, most likely out of memory");
    return file;
}

}  // namespace item3d
