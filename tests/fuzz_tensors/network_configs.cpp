#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/controlnet.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/blip2.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/networks/vision_language/clip_seg.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/networks/vision_language/clip_vision.h"
#include "item3d/networks/vision_language/image_processor.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Makes the network of a config.json. The first byte chooses the network's class. The file beside
/// it has half a million weights that fit no network, so loading must end with an error that says
/// what is missing.
ITEM3D_FUZZ_TARGET(network_configs, data, size) {
    using namespace item3d;
    using Load = void (*)(const std::filesystem::path&);
    static constexpr Load loaders[] = {
        [](const std::filesystem::path& folder) { load_unet(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_autoencoder(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_controlnet(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_clip_text(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_clip_vision(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_clip_model(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_clip_seg(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_blip(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { load_blip2(folder, at::kMeta); },
        [](const std::filesystem::path& folder) { ImageProcessor::load(folder, 224); }};
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string json = fuzz::as_text(data + 1, size - 1);
        const auto folder = fuzz::as_files("networks", {"config.json"}, json);
        static const bool weights_are_there = [&] {
            for (const char* stem : {"model", "diffusion_pytorch_model"})
                save_safetensors(folder / (std::string(stem) + ".safetensors"),
                                 {{"weight", at::zeros({1 << 19}, at::kByte)}});
            return true;
        }();
        ITEM3D_CHECK(weights_are_there, "weights are there");
        std::ofstream(folder / "preprocessor_config.json") << json;
        loaders[data[0] % std::size(loaders)](folder);
    });
}
