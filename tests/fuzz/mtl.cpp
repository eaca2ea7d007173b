#include "item3d/io/obj/mtl.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(mtl, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        read_mtl(fuzz::as_file("input.mtl", fuzz::as_text(data, size)), {"texture.png", "glaze"});
    });
}
