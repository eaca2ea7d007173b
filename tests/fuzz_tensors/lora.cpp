#include "item3d/networks/diffusion/lora.h"

#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed,
                                                item3d::fuzz::split_safetensors,
                                                item3d::fuzz::join_safetensors))

/// Fuses a LoRA into the tests' small networks. Their values may become anything.
ITEM3D_FUZZ_TARGET(lora, data, size) {
    using namespace item3d;
    static const auto models = std::filesystem::path(ITEM3D_TEST_DATA) / "models";
    static const LoraTargets targets{load_unet(models / "pipeline_sd/unet"),
                                     load_clip_text(models / "pipeline_sd/text_encoder"),
                                     ClipTextModel{nullptr}};
    return fuzz::read_or_refuse([&] {
        fuse_loras({{fuzz::as_file("lora.safetensors", fuzz::as_text(data, size)), 0.5}}, targets);
    });
}
