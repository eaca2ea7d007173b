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

/// Resamples bilinearly with clamped edges; returns the image itself for an equal size.
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

// True if the image looks like tangent-space normals, which are bluish on average; heights are
// grey.
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

std::string image_key(const MtlMap& map) {
    return map.folder.string() + "\n" + map.file;
}

bool is_same_image(const std::optional<MtlMap>& a, const std::optional<MtlMap>& b) {
    return a && b && image_key(*a) == image_key(*b);
}

/// Returns the channel that -imfchan names if the image has it, else `otherwise`.
int channel_of(const MtlMap& map, const Image& image, int otherwise) {
    const std::size_t named = std::string_view("rgb").find(map.channel);
    const int colors = image.channels < 3 ? 1 : 3;
    if (map.channel == 'm' && image.channels % 2 == 0) return image.channels - 1;
    if (map.channel != 0 && named != std::string_view::npos)
        return std::min(static_cast<int>(named), colors - 1);
    return std::min(otherwise, image.channels - 1);
}

/// Returns one channel: the channel that -imfchan names, or else alpha if it varies, or else the
/// mean of the colours.
Image opacity_values(const MtlMap& map, const Image& image) {
    Image result(image.width, image.height, 1);
    const auto value = [&](std::size_t pixel, int c) {
        return image
            .pixels[pixel * static_cast<std::size_t>(image.channels) + static_cast<std::size_t>(c)];
    };
    const int alpha = image.channels - 1;
    bool uses_alpha = false;
    for (std::size_t i = 0; image.channels % 2 == 0 && i < result.pixels.size(); ++i)
        uses_alpha = uses_alpha || value(i, alpha) != value(0, alpha);
    const bool is_named = map.channel != 0 && map.channel != 'l';
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        if (is_named) {
            result.pixels[i] = value(i, channel_of(map, image, 0));
        } else if (uses_alpha && map.channel == 0) {
            result.pixels[i] = value(i, alpha);
        } else if (image.channels < 3) {
            result.pixels[i] = value(i, 0);
        } else {
            result.pixels[i] = (value(i, 0) + value(i, 1) + value(i, 2)) / 3.0f;
        }
    }
    return result;
}

}  // namespace

ObjMaterials::ObjMaterials(Model& model, fs::path folder, std::string subject,
                           std::vector<fs::path> allowed)
    : model_(model),
      folder_(std::move(folder)),
      allowed_(std::move(allowed)),
      subject_(std::move(subject)) {}

fs::path ObjMaterials::find_image_file(const MtlMap& map) const {
    const std::vector<fs::path> folders{map.folder, folder_};
    if (!map.file_and_comment.empty()) {
        try {
            return resolve_beside(folder_, folders, map.file_and_comment, subject_);
        } catch (const InputError&) {
        }
    }
    return resolve_beside(folder_, folders, map.file, subject_, allowed_);
}

const Texture* ObjMaterials::read(const MtlMap& map) {
    const auto found = images_.find(image_key(map));
    if (found != images_.end()) return found->second ? &*found->second : nullptr;
    std::optional<Texture>& slot = images_[image_key(map)];
    try {
        const fs::path path = find_image_file(map);
        slot = decode_texture(read_bytes(path), path.string());
        slot->name = to_utf8(path.stem().string());
    } catch (const InputError& error) {
        warn(std::string(error.what()) + "; the material's factors are used instead");
    }
    return slot ? &*slot : nullptr;
}

int ObjMaterials::add_texture(const Texture& texture, const MtlMap& map) {
    const auto key = std::pair(image_key(map), map.clamp);
    const auto found = added_.find(key);
    if (found != added_.end()) return found->second;
    Texture copy = texture;
    if (map.clamp) copy.wrap_u = copy.wrap_v = Wrap::clamp_to_edge;
    model_.textures.push_back(std::move(copy));
    return added_[key] = static_cast<int>(model_.textures.size()) - 1;
}

// Adds a base colour with alpha, in the size of the larger image.
int ObjMaterials::add_cut_out(const Texture* base, const Texture& opacity,
                              const MtlMaterial& source) {
    const bool base_is_larger = base && base->image.width >= opacity.image.width;
    const Image& larger = base_is_larger ? base->image : opacity.image;
    const Image alpha =
        resample(opacity_values(*source.opacity_map, opacity.image), larger.width, larger.height);
    const Image colors = base ? resample(base->image, larger.width, larger.height) : Image();
    Texture texture;
    texture.name = base ? base->name : opacity.name;
    texture.bits_per_channel =
        std::max(base ? base->bits_per_channel : 8, opacity.bits_per_channel);
    if ((source.diffuse_map ? source.diffuse_map : source.opacity_map)->clamp)
        texture.wrap_u = texture.wrap_v = Wrap::clamp_to_edge;
    texture.image = Image(larger.width, larger.height, 4, 1.0f);
    for (std::size_t i = 0; i < alpha.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3 && base; ++c) {
            const auto channels = static_cast<std::size_t>(colors.channels);
            texture.image.pixels[4 * i + c] = colors.pixels[i * channels + (channels < 3 ? 0 : c)];
        }
        texture.image.pixels[4 * i + 3] = alpha.pixels[i];
    }
    model_.textures.push_back(std::move(texture));
    return static_cast<int>(model_.textures.size()) - 1;
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
        // The largest of the images determines the size of the combined image.
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
    const auto copy_channel = [&](const Texture* part, const auto& map, int otherwise, int to) {
        if (!part) return;
        const int from = channel_of(*map, part->image, otherwise);
        const Image scaled = resample(part->image, width, height);
        const std::size_t count = static_cast<std::size_t>(width) * height;
        for (std::size_t i = 0; i < count; ++i) {
            texture.image.pixels[3 * i + to] = scaled.pixels[i * scaled.channels + from];
        }
    };
    copy_channel(occlusion, source.occlusion_map, 0, 0);
    copy_channel(roughness, roughness_map, packed ? 1 : 0, 1);
    copy_channel(metallic, metallic_map, packed ? 2 : 0, 2);
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
             "' is a height map and is ignored; use a normal map ('norm')");
        return;
    }
    material.normal_texture = add_texture(*texture, *map);
    material.normal_scale = map->bump_multiplier;
}

void ObjMaterials::set_base_color(const MtlMaterial& source, Material& material) {
    const Vec3 diffuse = glm::clamp(source.diffuse.value_or(Vec3(0.8f)), 0.0f, 1.0f);
    material.base_color_factor = Vec4(diffuse, 1.0f);
    const Texture* base = source.diffuse_map ? read(*source.diffuse_map) : nullptr;
    const bool is_separate =
        source.opacity_map && !is_same_image(source.opacity_map, source.diffuse_map);
    const Texture* cut = is_separate ? read(*source.opacity_map) : nullptr;
    if (base) material.base_color_factor = Vec4(1.0f);
    if (source.diffuse_map && !base) material.missing_base_color = source.diffuse_map->file;
    if (cut) {
        material.base_color_texture = add_cut_out(base, *cut, source);
    } else if (base) {
        material.base_color_texture = add_texture(*base, *source.diffuse_map);
    }
    const float opacity =
        clamp_unit(source.opacity.value_or(1.0f - source.transparency.value_or(0.0f)));
    material.base_color_factor.w = opacity;
    if (opacity < 1.0f || source.opacity_map) material.alpha = Material::Alpha::blend;
}

int ObjMaterials::add(const MtlMaterial& source) {
    Material material;
    material.name = to_utf8(without_remark(source.name));
    set_base_color(source, material);
    set_metallic_roughness(source, material);
    set_normals(source, material);
    material.emissive_factor = glm::max(source.emission.value_or(Vec3(0.0f)), 0.0f);
    if (source.emission_map) {
        if (const Texture* texture = read(*source.emission_map)) {
            material.emissive_texture = add_texture(*texture, *source.emission_map);
            material.emissive_factor = Vec3(1.0f);
        }
    }
    has_opacity_map_.push_back(source.opacity_map.has_value());
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
}

void ObjMaterials::make_visible() {
    const auto is_invisible = [](const Material& material) {
        return material.base_color_factor.w <= 0.0f;
    };
    if (std::all_of(model_.materials.begin(), model_.materials.end(), is_invisible)) {
        warn(subject_ +
             ": all materials are fully transparent (d 0 or Tr 1 in its material library); they "
             "are read as opaque");
        for (std::size_t i = 0; i < model_.materials.size(); ++i) {
            model_.materials[i].base_color_factor.w = 1.0f;
            if (!has_opacity_map_[i]) model_.materials[i].alpha = Material::Alpha::opaque;
        }
        return;
    }
    for (const Material& material : model_.materials) {
        if (is_invisible(material)) {
            warn(subject_ + ": material '" + material.name +
                 "' is fully transparent (d 0 or Tr 1) and therefore invisible");
        }
    }
}

}  // namespace item3d
