#include "item3d/io/image/openexr.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(openexr, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_openexr({data, size}, "input"); });
}
