#include "item3d/layers/layer.h"

#include "item3d/layers/layer_use.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed,
                                                item3d::fuzz::split_safetensors,
                                                item3d::fuzz::join_safetensors))

ITEM3D_FUZZ_TARGET(layer, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto file = fuzz::as_file("layer.safetensors", fuzz::as_text(data, size));
        save_layer(fuzz::as_file("layer_again.safetensors", ""), load_layer(file));
    });
}
