#include "item3d/io/image/webp.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(webp, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_webp({data, size}, "input"); });
}
