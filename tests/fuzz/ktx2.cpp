#include "item3d/io/image/ktx2.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(ktx2, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_ktx2({data, size}, "input"); });
}
