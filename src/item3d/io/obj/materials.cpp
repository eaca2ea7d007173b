#include "item3d/io/obj/materials.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace fs = std::filesystem;
namespace {

/// Bilinear between texel centres, edges held; the image itself when the size is right already.
Image resample(const Image& image, int width, int height) {
    if (image.width == width && image.height == height) return image;
    Image result(width, height, image.channels);
    const auto position = [](int i, int to, int from) {
        const float at =
            (static_cast<float>(i) + 0.5f) * static_cast<float>(from) / static_cast<float>(to);
        return std::clamp(at - 0.5f, 0.0f, static_cast<float>(from - 1));
    };
    for (int y = 0; y < height; ++y) {
        const float v = position(y, height, image.height);
        const int y0 = static_cast<int>(v);
        const int y1 = std::min(y0 + 1, image.height - 1);
        for (int x = 0; x < width; ++x) {
            const float u = position(x, width, image.width);
            const int x0 = static_cast<int>(u);
            const int x1 = std::min(x0 + 1, image.width - 1);
            for (int c = 0; c < image.channels; ++c) {
                const float top = std::lerp(image.at(x0, y0, c), image.at(x1, y0, c), u - x0);
                const float bottom = std::lerp(image.at(x0, y1, c), image.at(x1, y1, c), u - x0);
                result.at(x, y, c) = std::lerp(top, bottom, v - static_cast<float>(y0));
            }
        }
    }
    return result;
}

// Tangent-space normal maps are bluish on average; pictures of heights are grey.
bool looks_like_normals(const Image& image) {
    if (image.channels < 3) return false;
    double sums[3] = {0, 0, 0};
    const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
    for (std::size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c)
            sums[c] += image.pixels[i * image.channels + c];
    }
    const double scale = 1.0 / static_cast<double>(count);
    return std::abs(sums[0] * scale - 0.5) < 0.15 && std::abs(sums[1] * scale - 0.5) < 0.15 &&
           sums[2] * scale > 0.7;
}

float clamp_unit(float value) {
    return std::clamp(value, 0.0f, 1.0f);
}

}  // namespace

ObjMaterials::ObjMaterials(Model& model, fs::path folder, std::string subject)
    : model_(model), folder_(std::move(folder)), subject_(std::move(subject)) {}

const Texture* ObjMaterials::read(const MtlMap& map) {
    const auto found = pictures_.find(map.file);
    if (found != pictures_.end()) return found->second ? &*found->second : nullptr;
    std::optional<Texture>& slot = pictures_[map.file];
    std::string name = map.file;
    std::replace(name.begin(), name.end(), '\\', '/');
    try {
        const fs::path path = resolve_in_folder(folder_, name, subject_);
        slot = decode_texture(read_bytes(path), path.string());
        slot->name = to_utf8(fs::path(name).stem().string());
    } catch (const InputError& error) {
        warn(std::string(error.what()) + "; the material's factors are used");
    }
    return slot ? &*slot : nullptr;
}

int ObjMaterials::add_texture(const Texture& texture, const MtlMap& map) {
    const auto key = std::pair(map.file, map.clamp);
    const auto found = added_.find(key);
    if (found != added_.end()) return found->second;
    Texture copy = texture;
    if (map.clamp) copy.wrap_u = copy.wrap_v = Wrap::clamp_to_edge;
    model_.textures.push_back(std::move(copy));
    return added_[key] = static_cast<int>(model_.textures.size()) - 1;
}

void ObjMaterials::set_metallic_roughness(const MtlMaterial& source, Material& material) {
    material.metallic_factor = clamp_unit(source.metallic.value_or(0.0f));
    if (source.roughness) {
        material.roughness_factor = clamp_unit(*source.roughness);
    } else if (source.specular_exponent) {
        material.roughness_factor =
            1.0f - std::sqrt(std::clamp(*source.specular_exponent, 0.0f, 1000.0f) / 1000.0f);
    } else {
        material.roughness_factor = 0.5f;
    }
    if (source.is_nvdiffrec && source.specular) {
        material.roughness_factor = clamp_unit(source.specular->y);
        material.metallic_factor = clamp_unit(source.specular->z);
    }

    const bool packed_specular = source.is_nvdiffrec && source.specular_map;
    const auto& roughness_map = packed_specular ? source.specular_map : source.roughness_map;
    const auto& metallic_map = packed_specular ? source.specular_map : source.metallic_map;
    const Texture* roughness = roughness_map ? read(*roughness_map) : nullptr;
    const Texture* metallic = metallic_map ? read(*metallic_map) : nullptr;
    const Texture* occlusion = source.occlusion_map ? read(*source.occlusion_map) : nullptr;
    if (!roughness && !metallic && !occlusion) return;

    const bool packed = roughness && roughness == metallic && roughness->image.channels >= 3;
    Texture texture;
    texture.name = source.name.empty() ? "orm" : to_utf8(source.name) + "_orm";
    int width = 0;
    int height = 0;
    for (const Texture* part : {roughness, metallic, occlusion}) {
        if (!part) continue;
        // The largest of the pictures gives the size.
        if (part->image.pixels.size() / part->image.channels >
            static_cast<std::size_t>(width) * height) {
            width = part->image.width;
            height = part->image.height;
        }
        texture.bits_per_channel = std::max(texture.bits_per_channel, part->bits_per_channel);
    }
    const auto& any_map = roughness  ? roughness_map
                          : metallic ? metallic_map
                                     : source.occlusion_map;
    if (any_map->clamp) texture.wrap_u = texture.wrap_v = Wrap::clamp_to_edge;
    texture.image = Image(width, height, 3, 1.0f);
    const auto copy_channel = [&](const Texture* part, int from, int to) {
        if (!part) return;
        const Image scaled = resample(part->image, width, height);
        const std::size_t count = static_cast<std::size_t>(width) * height;
        for (std::size_t i = 0; i < count; ++i) {
            texture.image.pixels[3 * i + to] = scaled.pixels[i * scaled.channels + from];
        }
    };
    copy_channel(occlusion, 0, 0);
    copy_channel(roughness, packed ? 1 : 0, 1);
    copy_channel(metallic, packed ? 2 : 0, 2);
    if (roughness) material.roughness_factor = 1.0f;
    if (metallic) material.metallic_factor = 1.0f;
    model_.textures.push_back(std::move(texture));
    const int index = static_cast<int>(model_.textures.size()) - 1;
    if (roughness || metallic) material.metallic_roughness_texture = index;
    if (occlusion) material.occlusion_texture = index;
}

void ObjMaterials::set_normals(const MtlMaterial& source, Material& material) {
    const auto& map = source.normal_map ? source.normal_map : source.bump_map;
    const Texture* texture = map ? read(*map) : nullptr;
    if (!texture) return;
    if (!source.normal_map && !looks_like_normals(texture->image)) {
        warn(subject_ + ": the bump map '" + to_utf8(map->file) +
             "' is a picture of heights and is left out; use a normal map ('norm')");
        return;
    }
    material.normal_texture = add_texture(*texture, *map);
    material.normal_scale = map->bump_multiplier;
}

int ObjMaterials::add(const MtlMaterial& source) {
    Material material;
    material.name = to_utf8(source.name);
    const Vec3 diffuse = glm::clamp(source.diffuse.value_or(Vec3(0.8f)), 0.0f, 1.0f);
    material.base_color_factor = Vec4(diffuse, 1.0f);
    if (source.diffuse_map) {
        if (const Texture* texture = read(*source.diffuse_map)) {
            material.base_color_factor = Vec4(1.0f);
            material.base_color_texture = add_texture(*texture, *source.diffuse_map);
        }
    }
    const float opacity = clamp_unit(source.opacity.value_or(1.0f));
    material.base_color_factor.w = opacity;
    if (opacity < 1.0f || source.opacity_map) material.alpha = Material::Alpha::blend;

    set_metallic_roughness(source, material);
    set_normals(source, material);
    material.emissive_factor = glm::max(source.emission.value_or(Vec3(0.0f)), 0.0f);
    if (source.emission_map) {
        if (const Texture* texture = read(*source.emission_map)) {
            material.emissive_texture = add_texture(*texture, *source.emission_map);
            material.emissive_factor = Vec3(1.0f);
        }
    }
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
}

}  // namespace item3d
