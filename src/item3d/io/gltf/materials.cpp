#include "item3d/io/gltf/materials.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/specular_glossiness.h"
#include "item3d/io/gltf/texture_source.h"
#include "item3d/io/gltf/uv_layouts.h"
#include "item3d/io/resources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr const char* specular_glossiness = "KHR_materials_pbrSpecularGlossiness";
constexpr std::string_view read_extensions[] = {"KHR_materials_unlit",
                                                "KHR_materials_emissive_strength",
                                                "KHR_materials_pbrSpecularGlossiness"};

Vec4 to_vec4(const std::vector<double>& v) {
    return Vec4(v[0], v[1], v[2], v[3]);
}
float unit(double value) {
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

Wrap read_wrap(const GltfObject& sampler, const char* key) {
    switch (sampler.integer(key, 10497)) {
        case 33071:
            return Wrap::clamp_to_edge;
        case 33648:
            return Wrap::mirrored_repeat;
        default:
            return Wrap::repeat;
    }
}

class MaterialReader {
  public:
    MaterialReader(const SourceDocument& document, Model& model)
        : document_(document), root_(root_of(document)), model_(model) {}

    /// Reads a material. Skips its textures if no primitive uses it (`use`).
    Material read(const GltfObject& source, const MaterialUse& use) {
        Material material;
        material.name = source.text("name", "");
        read_factors(source, material);
        const std::string alpha = source.text("alphaMode", "OPAQUE");
        if (alpha == "MASK") material.alpha = Material::Alpha::mask;
        if (alpha == "BLEND") material.alpha = Material::Alpha::blend;
        material.alpha_cutoff = static_cast<float>(source.number("alphaCutoff", 0.5));
        material.double_sided = source.boolean("doubleSided", false);
        material.unlit = find_extension(source, "KHR_materials_unlit").has_value();
        if (use.primitives > 0) read_textures(source, use, material);
        if (!has_metallic_roughness(source)) {
            if (const auto old = find_extension(source, specular_glossiness))
                convert_glossiness(source, *old, use, material);
        }
        if (const auto extensions = source.object("extensions")) {
            for (const auto& [name, value] : extensions->json().items()) {
                if (std::find(std::begin(read_extensions), std::end(read_extensions), name) ==
                    std::end(read_extensions))
                    material.other_extensions.push_back(name);
            }
        }
        return material;
    }

  private:
    void read_factors(const GltfObject& source, Material& material) {
        const auto pbr = source.object("pbrMetallicRoughness");
        if (has_metallic_roughness(source)) {
            if (const auto factor = pbr->numbers("baseColorFactor", 4); !factor.empty()) {
                material.base_color_factor = to_vec4(factor);
            }
            material.metallic_factor = unit(pbr->number("metallicFactor", 1.0));
            material.roughness_factor = unit(pbr->number("roughnessFactor", 1.0));
        } else if (const auto old = find_extension(source, specular_glossiness)) {
            if (const auto factor = old->numbers("diffuseFactor", 4); !factor.empty()) {
                material.base_color_factor = to_vec4(factor);
            }
            material.metallic_factor = 0.0f;
            material.roughness_factor = 1.0f - unit(old->number("glossinessFactor", 1.0));
        }
        if (const auto factor = source.numbers("emissiveFactor", 3); !factor.empty()) {
            material.emissive_factor = Vec3(factor[0], factor[1], factor[2]);
        }
        if (const auto strength = find_extension(source, "KHR_materials_emissive_strength")) {
            material.emissive_factor *=
                static_cast<float>(strength->number("emissiveStrength", 1.0));
        }
    }

    void read_textures(const GltfObject& source, const MaterialUse& use, Material& material) {
        const TextureSlots slots(source);
        const std::vector<UvLayout> layouts = material_uv_layouts(source);
        const auto read_slot = [&](const std::optional<GltfObject>& info, int& texture, int& uvs) {
            if (!info) return;
            const UvLayout layout = read_uv_layout(*info);
            if (!has_uv_map(*info, layout, use)) return;
            texture = read_texture(*info);
            uvs = static_cast<int>(std::find(layouts.begin(), layouts.end(), layout) -
                                   layouts.begin());
        };
        int base_color_uvs = 0;
        read_slot(slots.base_color, material.base_color_texture, base_color_uvs);
        if (slots.base_color && material.base_color_texture < 0)
            material.missing_base_color = image_name(*slots.base_color);
        if (has_metallic_roughness(source)) {
            read_slot(slots.metallic_roughness, material.metallic_roughness_texture,
                      material.metallic_roughness_uvs);
        }
        read_slot(slots.normal, material.normal_texture, material.normal_uvs);
        read_slot(slots.occlusion, material.occlusion_texture, material.occlusion_uvs);
        read_slot(slots.emissive, material.emissive_texture, material.emissive_uvs);
        if (slots.normal) {
            material.normal_scale = static_cast<float>(slots.normal->number("scale", 1.0));
        }
        if (slots.occlusion)
            material.occlusion_strength = unit(slots.occlusion->number("strength", 1.0));
    }

    // Returns the URI of a texture's image, its name, or its location in the document.
    std::string image_name(const GltfObject& info) const {
        try {
            return stated_image_name(info);
        } catch (const InputError&) {
            return info.where();  // the texture or its image is invalid, and read_texture() warned
        }
    }

    std::string stated_image_name(const GltfObject& info) const {
        const auto texture = info.index("index", root_.list_size("textures"));
        if (!texture) return info.where();
        const auto image =
            root_.item("textures", *texture).index("source", root_.list_size("images"));
        if (!image) return info.where();
        const GltfObject object = root_.item("images", *image);
        const std::string uri = object.text("uri", "");
        return uri.empty() || is_data_uri(uri) ? object.text("name", object.where()) : uri;
    }

    // Replaces base colour, metallic and roughness by a conversion of the older model's specular
    // colour. A file without a specular colour is read as a dielectric, although the extension's
    // default colour is white.
    void convert_glossiness(const GltfObject& source, const GltfObject& old, const MaterialUse& use,
                            Material& material) {
        const auto info = old.object("specularGlossinessTexture");
        const auto factor = old.numbers("specularFactor", 3);
        if (factor.empty() && !info) return;
        SpecularGlossiness values;
        values.diffuse_factor = material.base_color_factor;
        values.glossiness_factor = unit(old.number("glossinessFactor", 1.0));
        if (!factor.empty()) values.specular_factor = Vec3(factor[0], factor[1], factor[2]);
        int texture = -1;
        if (info && use.primitives > 0) {
            if (read_uv_layout(*info) != material_uv_layout(source) &&
                material.base_color_texture >= 0) {
                warn(document_.path.string() + ": " + info->where() +
                     " uses different texture coordinates than the diffuse texture; its factors "
                     "are used instead");
            } else if (has_uv_map(*info, read_uv_layout(*info), use)) {
                texture = read_texture(*info);
            }
        }
        const auto image_of = [&](int index) {
            return index < 0 ? nullptr : &model_.textures[static_cast<std::size_t>(index)].image;
        };
        values.diffuse = image_of(material.base_color_texture);
        values.specular_glossiness = image_of(texture);
        MetallicRoughness converted = to_metallic_roughness(values);
        material.base_color_factor = converted.base_color_factor;
        material.metallic_factor = converted.metallic_factor;
        material.roughness_factor = converted.roughness_factor;
        const int like = material.base_color_texture >= 0 ? material.base_color_texture : texture;
        const auto add = [&](std::optional<Image>& image, int& slot) {
            if (!image) return;
            Texture made = model_.textures[static_cast<std::size_t>(like)];
            made.image = std::move(*image);
            model_.textures.push_back(std::move(made));
            slot = static_cast<int>(model_.textures.size()) - 1;
        };
        add(converted.base_color, material.base_color_texture);
        add(converted.metallic_roughness, material.metallic_roughness_texture);
    }

    // True if some primitive with this material has the texture coordinates that a texture uses.
    // Warns if a primitive lacks them.
    bool has_uv_map(const GltfObject& info, const UvLayout& layout, const MaterialUse& use) const {
        const auto found = use.with_uv_map.find(layout.tex_coord);
        const std::size_t count = found == use.with_uv_map.end() ? 0 : found->second;
        if (count == use.primitives) return true;
        const std::string place = fmt::format("{}: {} uses TEXCOORD_{}", document_.path.string(),
                                              info.where(), layout.tex_coord);
        if (count == 0)
            warn(place + ", which is missing in its meshes; the material's factor is used instead");
        else
            warn(
                fmt::format("{}, which is missing in {} of its {} meshes; they use its first texel",
                            place, use.primitives - count, use.primitives));
        return count > 0;
    }

    // Reads a texture and returns its index; -1 if the texture or its image cannot be read.
    int read_texture(const GltfObject& info) {
        std::optional<std::size_t> index;
        try {
            index = info.index("index", root_.list_size("textures"));
            if (!index) info.fail("index is missing");
            const auto found = textures_.find(*index);
            if (found != textures_.end()) return found->second;
            model_.textures.push_back(load(root_.item("textures", *index)));
            return textures_[*index] = static_cast<int>(model_.textures.size()) - 1;
        } catch (const InputError& error) {
            warn(std::string(error.what()) + "; the material's factors are used instead");
        }
        if (index) textures_[*index] = -1;
        return -1;
    }

    Texture load(const GltfObject& source) const {
        Texture texture = read_texture_source(document_, source);
        if (const auto index = source.index("sampler", root_.list_size("samplers"))) {
            const GltfObject sampler = root_.item("samplers", *index);
            texture.wrap_u = read_wrap(sampler, "wrapS");
            texture.wrap_v = read_wrap(sampler, "wrapT");
            texture.nearest = sampler.integer("magFilter", 0) == 9728;
        }
        return texture;
    }

    const SourceDocument& document_;
    GltfObject root_;
    Model& model_;
    std::map<std::size_t, int> textures_;
};

}  // namespace

Material default_gltf_material() {
    return Material{};
}

void read_gltf_materials(const SourceDocument& document, const std::vector<MaterialUse>& uses,
                         Model& model) {
    MaterialReader reader(document, model);
    const GltfObject root = root_of(document);
    for (std::size_t i = 0; i < root.list_size("materials"); ++i) {
        model.materials.push_back(
            reader.read(root.item("materials", i), i < uses.size() ? uses[i] : MaterialUse{}));
    }
}

}  // namespace item3d
