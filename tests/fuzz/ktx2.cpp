#include "item3d/io/image/ktx2.h"

#include "tests/fuzz/fuzz.h"

#include <cstring>

/// Decodes KTX2. A few bytes may hold any number of pixels of one colour, which take a long time to
/// decode. Images of more than a quarter of a megapixel are therefore left out.
ITEM3D_FUZZ_TARGET(ktx2, data, size) {
    std::uint32_t sides[2] = {0, 0};  // width and height, little-endian
    if (size >= 28) std::memcpy(sides, data + 20, sizeof sides);
    if (std::uint64_t{sides[0]} * sides[1] > 1 << 18) return 0;
    return item3d::fuzz::read_or_refuse([&] { item3d::decode_ktx2({data, size}, "input"); });
}
