#include "item3d/layers/layer_mask.h"

#include "item3d/core/parallel.h"
#include "item3d/field/atlas/atlas.h"
#include "item3d/layers/layer_fit.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

const LayerImage* masked_image(const EditLayer& layer, const LayerMaterial& material) {
    for (const int image : material.images) {
        if (image < 0) continue;
        const LayerImage& own = layer.images[static_cast<std::size_t>(image)];
        if (own.mask.defined()) return &own;
    }
    return nullptr;
}

}  // namespace

LayerMask::LayerMask(const EditLayer& layer, const Model& model, int texture_size) {
    for (const auto& [index, material] : layer.materials) {
        const LayerImage* image = masked_image(layer, material);
        is_complete_ = is_complete_ && image != nullptr;
        if (image == nullptr) continue;
        const int own = material_like(layer, index, model);
        const auto [width, height] = atlas_size(model, own, texture_size);
        of_material_[own] = {image->mask.to(at::kFloat).div(255).contiguous(), wrap_of(model, own),
                             width > image->mask.size(1) || height > image->mask.size(0)};
    }
}

float LayerMask::weight_at(const Mask& mask, Vec2 uv) {
    const std::int64_t width = mask.weights.size(1), height = mask.weights.size(0);
    const float* weights = mask.weights.const_data_ptr<float>();
    const float x = wrap_coordinate(uv.x, mask.wrap.u) * static_cast<float>(width);
    const float y = wrap_coordinate(uv.y, mask.wrap.v) * static_cast<float>(height);
    const auto texel = [&](float column, float row) {
        const auto i = std::clamp<std::int64_t>(static_cast<std::int64_t>(column), 0, width - 1);
        const auto j = std::clamp<std::int64_t>(static_cast<std::int64_t>(row), 0, height - 1);
        return weights[j * width + i];
    };
    if (!mask.is_enlarged) return texel(std::floor(x), std::floor(y));
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float a = x - 0.5f - left, b = y - 0.5f - top;
    return std::lerp(std::lerp(texel(left, top), texel(left + 1, top), a),
                     std::lerp(texel(left, top + 1), texel(left + 1, top + 1), a), b);
}

at::Tensor LayerMask::weight(const Surface& surface) const {
    const at::Tensor uv = surface.uv.cpu().contiguous();
    const at::Tensor material = surface.material.cpu().contiguous();
    at::Tensor weights = at::zeros({uv.size(0), 1}, at::kFloat);
    const float* from = uv.const_data_ptr<float>();
    const auto* materials = material.const_data_ptr<std::int64_t>();
    float* to = weights.data_ptr<float>();
    parallel_for(
        "layer_mask", uv.size(0),
        [&](std::int64_t i) {
            const auto found = of_material_.find(materials[i]);
            if (found != of_material_.end())
                to[i] = weight_at(found->second, Vec2(from[2 * i], from[2 * i + 1]));
        },
        4096);
    return weights.to(surface.uv.device());
}

}  // namespace item3d
