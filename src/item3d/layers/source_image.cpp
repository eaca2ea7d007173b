#include "item3d/layers/source_image.h"

#include "item3d/field/bake/source_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

const Image* texels_at(const Model& model, int texture) {
    return texture >= 0 ? &model.textures[static_cast<std::size_t>(texture)].image : nullptr;
}

int texture_in(const Material& material, LayerSlot slot) {
    return slot == LayerSlot::base_color ? material.base_color_texture
           : slot == LayerSlot::normal   ? material.normal_texture
                                         : material.metallic_roughness_texture;
}

/// True if a texture's texels map one to one to those of the image, or if there is no texture.
bool fits(const Image* texels, int uvs, const LayerImage& image, int channels) {
    return texels == nullptr || (uvs == 0 && texels->width == image.width &&
                                 texels->height == image.height && texels->channels >= channels);
}

void fill(Image& image, const std::array<float, 4>& values) {
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = values[i % channels];
}

}  // namespace

std::int32_t to_file_value(float value, int bits) {
    // The rounding is that of all encoders. The comparison is false for NaN, which becomes 0.
    const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
    return static_cast<std::int32_t>(std::lround(clamped * (bits > 8 ? 65535.0f : 255.0f)));
}

float from_file_value(std::int32_t value, int bits) {
    return static_cast<float>(value) / (bits > 8 ? 65535.0f : 255.0f);
}

bool has_source_image(const Model& model, int index, const LayerImage& image,
                      const MaterialEdit& changes, bool remakes_uvs) {
    const Material& material = model.materials[static_cast<std::size_t>(index)];
    const Image* texels = texels_at(model, texture_in(material, image.slot));
    if (remakes_uvs && image.slot != LayerSlot::metallic_roughness && texels != nullptr)
        return false;
    switch (image.slot) {
        case LayerSlot::base_color:
            return !changes.includes_vertex_colors && fits(texels, 0, image, 1);
        case LayerSlot::normal:
            return fits(texels, material.normal_uvs, image, 3) &&
                   (texels == nullptr || material.normal_scale == 1.0f);
        case LayerSlot::metallic_roughness:
            break;
    }
    const Image* occlusion =
        changes.keeps_occlusion ? nullptr : texels_at(model, material.occlusion_texture);
    if (remakes_uvs && (texels != nullptr || occlusion != nullptr)) return false;
    return fits(texels, material.metallic_roughness_uvs, image, 3) &&
           fits(occlusion, material.occlusion_uvs, image, 1);
}

Image source_image(const Model& model, int index, const LayerImage& of_layer,
                   const MaterialEdit& changes) {
    const Material& material = model.materials[static_cast<std::size_t>(index)];
    const Image* texels = texels_at(model, texture_in(material, of_layer.slot));
    Image image(of_layer.width, of_layer.height, of_layer.channels);
    switch (of_layer.slot) {
        case LayerSlot::base_color: {
            const Vec4 factor = material.base_color_factor;
            if (texels != nullptr)
                copy_base_color(*texels, factor, image);
            else
                fill(image, {linear_to_srgb(factor.x), linear_to_srgb(factor.y),
                             linear_to_srgb(factor.z), factor.w});
            break;
        }
        case LayerSlot::normal:
            copy_normal(texels, image);
            break;
        case LayerSlot::metallic_roughness: {
            const bool own = !changes.keeps_occlusion && material.occlusion_texture >= 0;
            fill(image, {1.0f, material.roughness_factor, material.metallic_factor, 1.0f});
            copy_orm({own ? texels_at(model, material.occlusion_texture) : nullptr, texels,
                      own ? material.occlusion_strength : 1.0f},
                     material, image);
            break;
        }
    }
    return image;
}

std::optional<LayerSize> texture_size(const Model& model, int texture) {
    if (texture < 0) return std::nullopt;
    const Image& texels = *texels_at(model, texture);
    return LayerSize(texels.width, texels.height);
}

std::optional<LayerSize> source_size(const Model& model, int index, LayerSlot slot) {
    const Material& material = model.materials[static_cast<std::size_t>(index)];
    return texture_size(model, texture_in(material, slot));
}

std::optional<LayerSize> occlusion_size(const Model& model, int index, LayerSlot slot) {
    if (slot != LayerSlot::metallic_roughness) return std::nullopt;
    const Material& material = model.materials[static_cast<std::size_t>(index)];
    return texture_size(model, material.occlusion_texture);
}

}  // namespace item3d
