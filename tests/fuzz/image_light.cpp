#include "item3d/io/gltf/image_light.h"

#include "item3d/io/load_light.h"
#include "item3d/io/read_provenance.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed, item3d::fuzz::split_glb,
                                                item3d::fuzz::join_glb))

/// Reads a model's image-based light and its provenance.
ITEM3D_FUZZ_TARGET(image_light, data, size) {
    using namespace item3d;
    const auto file = fuzz::as_file("light.glb", fuzz::as_text(data, size));
    fuzz::read_or_refuse([&] { provenance_json(read_provenance(file)); });
    return fuzz::read_or_refuse([&] { load_light(file.string()); });
}
