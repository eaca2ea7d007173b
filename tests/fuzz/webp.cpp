#include "item3d/io/image/webp.h"

#include "tests/fuzz/fuzz.h"

#include <webp/decode.h>

/// Decodes WebP. A few bytes may hold any number of pixels of one colour, which take a long time to
/// decode. Images and frames of animations with more than a quarter of a megapixel are therefore
/// left out.
ITEM3D_FUZZ_TARGET(webp, data, size) {
    const std::string all = item3d::fuzz::as_text(data, size);
    const auto is_large = [&](std::size_t at) {
        int width = 0, height = 0;
        return at < size && WebPGetInfo(data + at, size - at, &width, &height) &&
               width * std::int64_t{height} > 1 << 18;
    };
    if (is_large(0)) return 0;
    for (std::size_t at = all.find("VP8"); at != all.npos; at = all.find("VP8", at + 1))
        if (is_large(at + 8)) return 0;
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_webp({data, size}, "input"); });
}
