#include "apps/parity/parity.h"
#include "item3d/networks/diffusion/controlnet.h"

namespace item3d::parity {

void check_controlnet(Case& golden) {
    ControlNet controlnet = load_controlnet(golden.folder() / "controlnet");
    UNet2DCondition unet = load_unet(golden.folder() / "unet");
    const at::Tensor sample = golden.input("sample"), timesteps = golden.input("timesteps");
    const at::Tensor context = golden.input("encoder_hidden_states");
    const at::Tensor image = golden.input("controlnet_cond");
    const double scale = golden.input("conditioning_scale").item<double>();

    for (std::int64_t i = 0; i < timesteps.size(0); ++i) {
        const std::string number = std::to_string(i);
        const UNetResiduals whole = controlnet(sample, timesteps[i], context, image);
        golden.compare("sample_" + number,
                       unet(sample, timesteps[i], context, AddedCondition{}, whole),
                       within::guidance_step);
        golden.compare("sample_scaled_" + number,
                       unet(sample, timesteps[i], context, AddedCondition{},
                            controlnet(sample, timesteps[i], context, image, scale)),
                       within::guidance_step);
        golden.compare("sample_plain_" + number, unet(sample, timesteps[i], context),
                       within::one_pass);
        if (i > 0) continue;
        for (std::size_t j = 0; j < whole.down.size(); ++j)
            golden.compare("down_" + std::to_string(j), whole.down[j], within::guidance_step);
        golden.compare("mid", whole.mid, within::guidance_step);
    }
}

}  // namespace item3d::parity
