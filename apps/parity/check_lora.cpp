#include "apps/parity/parity.h"
#include "item3d/core/format.h"
#include "item3d/networks/diffusion/lora.h"

namespace item3d::parity {

void check_lora(Case& golden) {
    const Config meta = golden.meta();
    const std::filesystem::path& folder = golden.folder();
    for (const std::string& file : meta.texts("files", {})) {
        for (const double scale : meta.numbers("lora_scales")) {
            LoraTargets targets;  // loaded each time, because fusing changes them
            targets.unet = load_unet(folder / meta.text("unet", ""));
            targets.text_encoder = load_clip_text(folder / meta.text("text_encoder", ""));
            fuse_loras({{folder / (file + ".safetensors"), scale}}, targets);
            golden.compare(fmt::format("{}.sample_{:.1f}", file, scale),
                           targets.unet(golden.input("sample"), golden.input("timestep"),
                                        golden.input("encoder_hidden_states")),
                           within::guidance_step);
            golden.compare(fmt::format("{}.last_hidden_state_{:.1f}", file, scale),
                           targets.text_encoder(golden.input("input_ids")).last_hidden_state,
                           within::guidance_step);
        }
    }
}

}  // namespace item3d::parity
