#include "item3d/hub/cache.h"
#include "item3d/hub/selection.h"
#include "tests/fuzz/mutate.h"

#include <nlohmann/json.hpp>

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Reads what a hub says about a repository. The first byte chooses the kind: model_index.json
/// (with or without a variant), an index of shards, or a name.
ITEM3D_FUZZ_TARGET(hub_files, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    static const std::vector<std::string> files = {
        "model_index.json",
        "prior.json",
        "unet/config.json",
        "unet/diffusion_pytorch_model.bin",
        "unet/diffusion_pytorch_model.safetensors.index.json",
        "unet/diffusion_pytorch_model-1.safetensors",
        "vae/config.json",
        "vae/diffusion_pytorch_model.fp16.safetensors",
        "text_encoder/model.safetensors"};
    return fuzz::read_or_refuse([&] {
        const std::string text = fuzz::as_text(data + 1, size - 1);
        switch (data[0] % 4) {
            case 0:
                select_files("org/name", text, files, "");
                break;
            case 1:
                select_files("org/name", text, files, "fp16");
                break;
            case 2:
                shards_of_index("org/name", files[4], text, files);
                break;
            default:
                stays_inside(text);
                if (const auto name = RepositoryName::parse(text))
                    CachedRepository("/dev/shm/item3d_fuzz_none", name->name)
                        .find_snapshot(name->revision_or_main());
        }
    });
}
