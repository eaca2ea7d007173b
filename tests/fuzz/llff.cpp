#include "item3d/reconstruct/dataset/llff.h"

#include "item3d/reconstruct/dataset/source.h"
#include "tests/fuzz/fuzz.h"

/// Reads poses_bounds.npy beside two images, which are not opened.
ITEM3D_FUZZ_TARGET(llff, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto file = fuzz::as_file("poses_bounds.npy", fuzz::as_text(data, size));
        const auto images = fuzz::as_files("llff", {"1.png", "2.png"}, "\n====\n");
        read_llff(file, images);
    });
}
