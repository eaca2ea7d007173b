#include "item3d/reconstruct/stage.h"

namespace item3d {

bool Learning::update_light(const Appearance& appearance, int index, int every) {
    const bool learns = index % every == 0;
    if (learns) {
        light = appearance.light.prefiltered();
    } else if (index % every == 1 || light.specular.empty()) {
        // Between, the light stands still: what a resumed run prefilters is what there was.
        const torch::NoGradGuard no_gradient;
        light = appearance.light.prefiltered();
    }
    return learns;
}

void Learning::note_losses(const torch::Tensor& picture, const torch::Tensor& mask) {
    curves.picture.push_back(picture.item<double>());
    curves.mask.push_back(mask.item<double>());
}

torch::Tensor curve_tensor(const std::vector<double>& values) {
    return torch::tensor(values, torch::kFloat64);
}

std::vector<double> curve_values(const torch::Tensor& tensor) {
    const torch::Tensor flat = tensor.contiguous();
    return {flat.const_data_ptr<double>(), flat.const_data_ptr<double>() + flat.numel()};
}

NamedTensors Stage::state() const {
    NamedTensors tensors;
    append_parameters(tensors, "field.", *appearance_.field);
    const auto& levels = appearance_.light.parameters();
    for (std::size_t i = 0; i < levels.size(); ++i)
        tensors.emplace_back("light." + std::to_string(i), levels[i].detach());
    for (const auto& [name, tensor] : learning_.optimizer.state())
        tensors.emplace_back("optimizer." + name, tensor);
    tensors.emplace_back("random",
                         torch::tensor({static_cast<std::int64_t>(learning_.random.counter())}));
    tensors.emplace_back("iteration", torch::tensor({std::int64_t{learning_.iteration}}));
    tensors.emplace_back("curve.picture", curve_tensor(learning_.curves.picture));
    tensors.emplace_back("curve.mask", curve_tensor(learning_.curves.mask));
    return tensors;
}

void Stage::load_state(const CheckpointReader& reader) {
    reader.parameters("field.", *appearance_.field);
    const auto& levels = appearance_.light.parameters();
    for (std::size_t i = 0; i < levels.size(); ++i)
        reader.copy("light." + std::to_string(i), levels[i]);
    learning_.optimizer.load_state(reader.with_prefix("optimizer."));
    learning_.iteration = static_cast<int>(reader.get("iteration").item<std::int64_t>());
    learning_.curves = {curve_values(reader.get("curve.picture")),
                        curve_values(reader.get("curve.mask"))};
}

}  // namespace item3d
