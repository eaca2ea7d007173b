#include "item3d/reconstruct/dataset/camera_facts.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(camera_facts, data, size) {
    using namespace item3d;
    const Bytes file = fuzz::as_bytes(data, size);
    return fuzz::read_or_refuse([&] {
        focal_in_pixels(camera_facts(file), 64, 48);
        stored_size(file);
    });
}
