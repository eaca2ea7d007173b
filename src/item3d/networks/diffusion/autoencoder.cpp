#include "item3d/networks/diffusion/autoencoder.h"

#include "item3d/networks/diffusion/autoencoder_kl.h"
#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/networks/layers/load_parameters.h"

#include <string>
#include <utility>

namespace item3d {

std::shared_ptr<Autoencoder> load_autoencoder(const std::filesystem::path& folder,
                                              at::Device device, at::ScalarType dtype,
                                              bool with_decoder, WeightUse use) {
    const Config config = Config::read(folder / "config.json");
    const std::string kind = config.text("_class_name", "");
    const bool tiny = kind == "AutoencoderTiny";
    if (!tiny && kind != "AutoencoderKL")
        config.fail("_class_name", "AutoencoderKL or AutoencoderTiny");

    Weights weights = Weights::open(folder, "diffusion_pytorch_model");
    // The first published checkpoints use other names for the attention's layers.
    weights.rename([&](const std::string& name) {
        static const std::pair<std::string, std::string> old_names[] = {
            {".query.", ".to_q."},
            {".key.", ".to_k."},
            {".value.", ".to_v."},
            {".proj_attn.", ".to_out.0."}};
        if (!tiny && !with_decoder &&
            (name.starts_with("decoder.") || name.starts_with("post_quant_conv.")))
            return std::string();
        for (const auto& [old_name, new_name] : old_names) {
            const auto at = name.find(old_name);
            if (at == std::string::npos || name.find(".attentions.") == std::string::npos) continue;
            return name.substr(0, at) + new_name + name.substr(at + old_name.size());
        }
        return name;
    });

    std::shared_ptr<Autoencoder> result;
    if (tiny) {
        const auto values = AutoencoderTinyConfig::from_config(config);
        check_plausible(weights, values.min_parameters());
        result = without_initial_values([&] { return std::make_shared<AutoencoderTiny>(values); });
    } else {
        const auto values = AutoencoderKLConfig::from_config(config);
        check_plausible(weights, values.min_parameters());
        result = without_initial_values(
            [&] { return std::make_shared<AutoencoderKL>(values, with_decoder); });
    }
    load_parameters(*result, weights, device, dtype, use);
    result->eval();
    return result;
}

}  // namespace item3d
