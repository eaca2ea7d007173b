#include "item3d/io/obj/read.h"
#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(obj, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse(
        [&] { read_obj("/dev/shm/item3d_fuzz/model.obj", fuzz::as_bytes(data, size)); });
}
