#include "item3d/io/gltf/read.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed, item3d::fuzz::split_glb,
                                                item3d::fuzz::join_glb))

ITEM3D_FUZZ_TARGET(gltf, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse(
        [&] { read_gltf("/dev/shm/item3d_fuzz/model.glb", fuzz::as_bytes(data, size)); });
}
