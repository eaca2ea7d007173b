#include "item3d/io/image/png.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(png, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_png({data, size}, "input"); });
}
