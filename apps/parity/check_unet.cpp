#include "apps/parity/parity.h"
#include "item3d/networks/diffusion/unet.h"

namespace item3d::parity {
namespace {

AddedCondition added_condition(const Case& golden, std::int64_t rows) {
    if (!golden.has("in.text_embeds")) return {};
    return {golden.input("text_embeds").slice(0, 0, rows),
            golden.input("time_ids").slice(0, 0, rows)};
}

}  // namespace

void check_unet(Case& golden) {
    UNet2DCondition unet = load_unet(golden.folder());
    const at::Tensor sample = golden.input("sample");
    const at::Tensor timesteps = golden.input("timesteps");
    const at::Tensor context = golden.input("encoder_hidden_states");
    const auto rows = sample.size(0), runs = timesteps.size(0);
    const AddedCondition added = added_condition(golden, rows);

    for (std::int64_t i = 0; i < runs; ++i)
        golden.compare("sample_" + std::to_string(i), unet(sample, timesteps[i], context, added),
                       within::one_pass);
    if (golden.has("out.sample_float_t"))
        golden.compare("sample_float_t",
                       unet(sample, golden.input("timestep_float").expand({rows}), context, added),
                       within::one_pass);
    if (golden.has("out.sample_odd"))
        golden.compare("sample_odd",
                       unet(golden.input("sample_odd"), timesteps[runs - 1][-1].reshape({1}),
                            context.slice(0, 0, 1), added_condition(golden, 1)),
                       within::one_pass);
    const at::Tensor sinusoids = unet->time_sinusoids(timesteps[runs - 1]);
    golden.compare("time_proj", sinusoids, within::one_pass);
    golden.compare("time_embedding", unet->time_embedding(sinusoids), within::one_pass);

    unet->to(at::kBFloat16);
    golden.orient("sample_bf16_0", unet(sample, timesteps[0], context, added), "sample_0");
}

}  // namespace item3d::parity
