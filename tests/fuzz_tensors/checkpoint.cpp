#include "item3d/tensors/checkpoint.h"

#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed,
                                                item3d::fuzz::split_safetensors,
                                                item3d::fuzz::join_safetensors))

/// Loads a checkpoint and asks it for tensors, as a run does that continues from it.
ITEM3D_FUZZ_TARGET(checkpoint, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto path = fuzz::as_file("checkpoint.safetensors", fuzz::as_text(data, size));
        const auto checkpoint = load_checkpoint(path);
        const CheckpointReader reader("checkpoint", checkpoint->tensors);
        at::Tensor target = at::zeros({4, 2});
        reader.copy("field", target);
        require_same_identity(path, checkpoint->identity, {{"seed", 1}, {"model", "mug"}},
                              {{"model", "belongs to another model"}});
    });
}
