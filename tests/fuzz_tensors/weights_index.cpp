#include "item3d/tensors/weights.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Reads an index of weights beside two shards, which hold the tensors "a", "b" and "c".
ITEM3D_FUZZ_TARGET(weights_index, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto index = fuzz::as_file("model.safetensors.index.json", fuzz::as_text(data, size));
        static const bool shards_are_there = [&] {
            save_safetensors(index.parent_path() / "model-1.safetensors",
                             {{"a", at::zeros({2})}, {"b", at::zeros({2, 3})}});
            save_safetensors(index.parent_path() / "model-2.safetensors", {{"c", at::zeros({1})}});
            return true;
        }();
        ITEM3D_CHECK(shards_are_there, "shards are there");
        const Weights weights = Weights::open(index.parent_path(), "model");
        for (const std::string& name : weights.names())
            weights.tensor(name).sum().item<float>();
        check_plausible(weights, 8);
    });
}
