#include "item3d/reconstruct/dataset/camera_metadata.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(camera_metadata, data, size) {
    using namespace item3d;
    const Bytes file = fuzz::as_bytes(data, size);
    return fuzz::read_or_refuse([&] {
        focal_in_pixels(camera_metadata(file), 64, 48);
        stored_size(file);
    });
}
