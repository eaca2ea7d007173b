#include "item3d/io/gltf/read.h"
#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(gltf, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse(
        [&] { read_gltf("/dev/shm/item3d_fuzz/model.glb", fuzz::as_bytes(data, size)); });
}
