#include "item3d/scene/visibility.h"

#include <algorithm>
#include <numeric>

namespace item3d {
namespace {

float largest_alpha(const Image& image) {
    if (image.channels % 2 != 0) return 1.0f;
    float largest = 0.0f;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = channels - 1; i < image.pixels.size(); i += channels)
        largest = std::max(largest, image.pixels[i]);
    return largest;
}

bool is_transparent(const Model& model, const Primitive& primitive) {
    const Material& material = model.materials[static_cast<std::size_t>(primitive.material)];
    if (material.alpha == Material::Alpha::opaque) return false;
    float alpha = material.base_color_factor.w;
    if (material.base_color_texture >= 0) {
        const auto index = static_cast<std::size_t>(material.base_color_texture);
        alpha *= largest_alpha(model.textures[index].image);
    }
    if (!primitive.colors.empty()) {
        float maximum = 0.0f;
        for (const Vec4& color : primitive.colors)
            maximum = std::max(maximum, color.w);
        alpha *= maximum;
    }
    const bool is_cut = material.alpha == Material::Alpha::mask && alpha < material.alpha_cutoff;
    return alpha <= 0.0f || is_cut;
}

bool has_area(const Primitive& primitive) {
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
        const auto at = [&](std::size_t k) {
            return glm::dvec3(primitive.positions[primitive.indices[t + k]]);
        };
        const glm::dvec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
        if (glm::dot(normal, normal) > 0.0) return true;
    }
    return false;
}

}  // namespace

bool is_visible(const Model& model, const std::vector<int>& materials) {
    return std::any_of(
        model.primitives.begin(), model.primitives.end(), [&](const Primitive& primitive) {
            return std::find(materials.begin(), materials.end(), primitive.material) !=
                       materials.end() &&
                   !is_transparent(model, primitive) && has_area(primitive);
        });
}

bool is_visible(const Model& model) {
    std::vector<int> all(model.materials.size());
    std::iota(all.begin(), all.end(), 0);
    return is_visible(model, all);
}

}  // namespace item3d
