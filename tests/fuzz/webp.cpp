#include "item3d/io/image/webp.h"

#include "tests/fuzz/fuzz.h"

#include <webp/decode.h>

/// Few bytes may hold any number of pixels of one colour, which take their time: larger pictures
/// than a quarter of a megapixel are left out.
ITEM3D_FUZZ_TARGET(webp, data, size) {
    int width = 0, height = 0;
    if (WebPGetInfo(data, size, &width, &height) && width * std::int64_t{height} > 1 << 18)
        return 0;
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_webp({data, size}, "input"); });
}
