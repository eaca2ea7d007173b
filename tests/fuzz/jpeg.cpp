#include "item3d/io/image/jpeg.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(jpeg, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_jpeg({data, size}, "input"); });
}
