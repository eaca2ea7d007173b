#include "item3d/reconstruct/dataset/transforms.h"

#include "item3d/reconstruct/dataset/source.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Reads transforms.json in the forms of NeRF-synthetic and of nerfstudio.
ITEM3D_FUZZ_TARGET(transforms, data, size) {
    using namespace item3d;
    const auto folder =
        fuzz::as_files("transforms", {"transforms_train.json"}, fuzz::as_text(data, size));
    fuzz::read_or_refuse([&] { read_nerf_synthetic(folder); });
    return fuzz::read_or_refuse([&] { read_nerfstudio(folder / "transforms_train.json"); });
}
