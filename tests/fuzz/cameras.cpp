#include "item3d/scene/camera.h"
#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(cameras, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse(
        [&] { load_cameras(fuzz::as_file("transforms.json", fuzz::as_text(data, size))); });
}
