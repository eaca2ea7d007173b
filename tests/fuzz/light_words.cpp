#include "item3d/lighting/words.h"
#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(light_words, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] { parse_light_words(fuzz::as_text(data, size), 30); });
}
