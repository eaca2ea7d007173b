#include "item3d/io/image/radiance.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(radiance, data, size) {
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_radiance({data, size}, "input"); });
}
