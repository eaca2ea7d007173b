#include "item3d/reconstruct/stage.h"

#include "item3d/reconstruct/surface/light_scale.h"

#include <numeric>
#include <utility>

namespace item3d {

bool Learning::update_light(Appearance& appearance, int index, int every) {
    const bool learns = index % every == 0;
    if (learns) {
        light = appearance.light.prefiltered();
    } else if (index % every == 1 || light.specular.empty()) {
        // The light does not change until the next update, so a resumed run prefilters the same
        // light.
        const at::NoGradGuard no_gradient;
        light = appearance.light.prefiltered();
    }
    const at::Tensor factor = balance_base_color(appearance.field, appearance.light);
    base_color_factor = learns ? factor : at::Tensor();
    return learns;
}

void Learning::note_losses(const at::Tensor& image, const at::Tensor& mask) {
    curves.image.push_back(image.item<double>());
    curves.mask.push_back(mask.item<double>());
}

void ViewOrder::shuffle(std::int64_t round) {
    Random random(seed_, RandomStream::view_order, static_cast<std::uint64_t>(round) << 32);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (std::size_t i = order_.size(); i > 1; --i)
        std::swap(order_[i - 1],
                  order_[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(i)))]);
    round_ = round;
}

at::Tensor curve_tensor(const std::vector<double>& values) {
    return at::tensor(values, at::kDouble);
}

std::vector<double> curve_values(const at::Tensor& tensor) {
    const at::Tensor flat = tensor.contiguous();
    return {flat.const_data_ptr<double>(), flat.const_data_ptr<double>() + flat.numel()};
}

NamedTensors Stage::state() const {
    NamedTensors tensors;
    tensors.emplace_back("light.scale", appearance_.light.log_scale().detach());
    append_parameters(tensors, "field.", appearance_.field->named_parameters());
    const auto& levels = appearance_.light.parameters();
    for (std::size_t i = 0; i < levels.size(); ++i)
        tensors.emplace_back("light." + std::to_string(i), levels[i].detach());
    for (auto& named : corrections_.state())
        tensors.push_back(std::move(named));
    for (const auto& [name, tensor] : learning_.optimizer.state())
        tensors.emplace_back("optimizer." + name, tensor);
    tensors.emplace_back("random",
                         at::tensor({static_cast<std::int64_t>(learning_.random.counter())}));
    tensors.emplace_back("iteration", at::tensor({std::int64_t{learning_.iteration}}));
    tensors.emplace_back("curve.picture", curve_tensor(learning_.curves.image));
    tensors.emplace_back("curve.mask", curve_tensor(learning_.curves.mask));
    return tensors;
}

void Stage::load_state(const CheckpointReader& reader) {
    reader.parameters("field.", appearance_.field->named_parameters());
    const auto& levels = appearance_.light.parameters();
    for (std::size_t i = 0; i < levels.size(); ++i)
        reader.copy("light." + std::to_string(i), levels[i]);
    reader.copy("light.scale", appearance_.light.log_scale());
    corrections_.load_state(reader);
    learning_.optimizer.load_state(reader.with_prefix("optimizer."));
    learning_.iteration = static_cast<int>(reader.get("iteration").item<std::int64_t>());
    learning_.curves = {curve_values(reader.get("curve.picture")),
                        curve_values(reader.get("curve.mask"))};
}

}  // namespace item3d
