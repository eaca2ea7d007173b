#include "item3d/io/gltf/materials.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/texture_source.h"
#include "item3d/io/resources.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr const char* specular_glossiness = "KHR_materials_pbrSpecularGlossiness";

std::optional<GltfObject> extension(const GltfObject& object, const char* name) {
    const auto extensions = object.object("extensions");
    return extensions ? extensions->object(name) : std::nullopt;
}

std::optional<GltfObject> child(const std::optional<GltfObject>& object, const char* name) {
    return object ? object->object(name) : std::nullopt;
}

/// The texture infos of a material by what they are for.
struct TextureSlots {
    std::optional<GltfObject> base_color, metallic_roughness, normal, occlusion, emissive;

    explicit TextureSlots(const GltfObject& material)
        : base_color(child(material.object("pbrMetallicRoughness"), "baseColorTexture")),
          metallic_roughness(
              child(material.object("pbrMetallicRoughness"), "metallicRoughnessTexture")),
          normal(material.object("normalTexture")),
          occlusion(material.object("occlusionTexture")),
          emissive(material.object("emissiveTexture")) {
        if (!material.has("pbrMetallicRoughness")) {
            base_color = child(extension(material, specular_glossiness), "diffuseTexture");
        }
    }
};

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

    Material read(const GltfObject& source, bool with_textures) {
        Material material;
        material.name = source.text("name", "");
        read_factors(source, material);
        const std::string alpha = source.text("alphaMode", "OPAQUE");
        if (alpha == "MASK") material.alpha = Material::Alpha::mask;
        if (alpha == "BLEND") material.alpha = Material::Alpha::blend;
        material.alpha_cutoff = static_cast<float>(source.number("alphaCutoff", 0.5));
        material.double_sided = source.boolean("doubleSided", false);
        material.unlit = extension(source, "KHR_materials_unlit").has_value();
        if (with_textures) read_textures(source, material);
        return material;
    }

  private:
    void read_factors(const GltfObject& source, Material& material) {
        if (const auto pbr = source.object("pbrMetallicRoughness")) {
            if (const auto factor = pbr->numbers("baseColorFactor", 4); !factor.empty()) {
                material.base_color_factor = to_vec4(factor);
            }
            material.metallic_factor = unit(pbr->number("metallicFactor", 1.0));
            material.roughness_factor = unit(pbr->number("roughnessFactor", 1.0));
        } else if (const auto old = extension(source, specular_glossiness)) {
            if (const auto factor = old->numbers("diffuseFactor", 4); !factor.empty()) {
                material.base_color_factor = to_vec4(factor);
            }
            material.metallic_factor = 0.0f;
            material.roughness_factor = 1.0f - unit(old->number("glossinessFactor", 1.0));
        }
        if (const auto factor = source.numbers("emissiveFactor", 3); !factor.empty()) {
            material.emissive_factor = Vec3(factor[0], factor[1], factor[2]);
        }
        if (const auto strength = extension(source, "KHR_materials_emissive_strength")) {
            material.emissive_factor *=
                static_cast<float>(strength->number("emissiveStrength", 1.0));
        }
    }

    void read_textures(const GltfObject& source, Material& material) {
        const TextureSlots slots(source);
        const UvLayout layout = material_uv_layout(source);
        const auto read_slot = [&](const std::optional<GltfObject>& info) {
            if (!info) return -1;
            if (read_uv_layout(*info) != layout) {
                warn(document_.path.string() + ": " + info->where() +
                     " uses other texture coordinates than the material's first texture and is not "
                     "shown");
                return -1;
            }
            return read_texture(*info);
        };
        material.base_color_texture = read_slot(slots.base_color);
        if (slots.base_color && material.base_color_texture < 0)
            material.missing_base_color = picture_name(*slots.base_color);
        material.metallic_roughness_texture = read_slot(slots.metallic_roughness);
        material.normal_texture = read_slot(slots.normal);
        material.occlusion_texture = read_slot(slots.occlusion);
        material.emissive_texture = read_slot(slots.emissive);
        if (slots.normal) {
            material.normal_scale = static_cast<float>(slots.normal->number("scale", 1.0));
        }
        if (slots.occlusion)
            material.occlusion_strength = unit(slots.occlusion->number("strength", 1.0));
    }

    // The address of a texture's picture, its name, or its place in the document.
    std::string picture_name(const GltfObject& info) const {
        const auto texture = info.index("index", root_.list_size("textures"));
        if (!texture) return info.where();
        const auto image =
            root_.item("textures", *texture).index("source", root_.list_size("images"));
        if (!image) return info.where();
        const GltfObject object = root_.item("images", *image);
        const std::string uri = object.text("uri", "");
        return uri.empty() || is_data_uri(uri) ? object.text("name", object.where()) : uri;
    }

    // -1 when the picture cannot be read.
    int read_texture(const GltfObject& info) {
        const auto index = info.index("index", root_.list_size("textures"));
        if (!index) info.fail("index is missing");
        const auto found = textures_.find(*index);
        if (found != textures_.end()) return found->second;
        int result = -1;
        try {
            model_.textures.push_back(load(root_.item("textures", *index)));
            result = static_cast<int>(model_.textures.size()) - 1;
        } catch (const InputError& error) {
            warn(std::string(error.what()) + "; the material's factors are used");
        }
        return textures_[*index] = result;
    }

    Texture load(const GltfObject& source) const {
        Texture texture = read_texture_source(document_, source);
        if (const auto index = source.index("sampler", root_.list_size("samplers"))) {
            const GltfObject sampler = root_.item("samplers", *index);
            texture.wrap_u = read_wrap(sampler, "wrapS");
            texture.wrap_v = read_wrap(sampler, "wrapT");
        }
        return texture;
    }

    const SourceDocument& document_;
    GltfObject root_;
    Model& model_;
    std::map<std::size_t, int> textures_;
};

}  // namespace

bool UvLayout::is_transformed() const {
    return offset != Vec2(0.0f) || rotation != 0.0f || scale != Vec2(1.0f);
}

Vec2 UvLayout::apply(Vec2 uv) const {
    const Vec2 scaled = uv * scale;
    const float c = std::cos(rotation);
    const float s = std::sin(rotation);
    return offset + Vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

UvLayout read_uv_layout(const GltfObject& info) {
    UvLayout layout;
    layout.tex_coord = info.integer("texCoord", 0);
    if (const auto transform = extension(info, "KHR_texture_transform")) {
        if (const auto v = transform->numbers("offset", 2); !v.empty())
            layout.offset = Vec2(v[0], v[1]);
        if (const auto v = transform->numbers("scale", 2); !v.empty())
            layout.scale = Vec2(v[0], v[1]);
        layout.rotation = static_cast<float>(transform->number("rotation", 0.0));
        layout.tex_coord = transform->integer("texCoord", layout.tex_coord);
    }
    return layout;
}

UvLayout material_uv_layout(const GltfObject& material) {
    const TextureSlots slots(material);
    for (const auto* slot : {&slots.base_color, &slots.metallic_roughness, &slots.normal,
                             &slots.occlusion, &slots.emissive}) {
        if (*slot) return read_uv_layout(**slot);
    }
    return {};
}

Material default_gltf_material() {
    return Material{};
}

void read_gltf_materials(const SourceDocument& document, const std::vector<bool>& used,
                         Model& model) {
    MaterialReader reader(document, model);
    const GltfObject root = root_of(document);
    for (std::size_t i = 0; i < root.list_size("materials"); ++i) {
        model.materials.push_back(
            reader.read(root.item("materials", i), i < used.size() && used[i]));
    }
}

}  // namespace item3d
