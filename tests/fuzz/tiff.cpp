#include "item3d/io/image/tiff.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(tiff, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_tiff({data, size}, "input"); });
}
