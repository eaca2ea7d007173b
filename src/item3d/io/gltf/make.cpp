#include "item3d/io/gltf/make.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/texture_source.h"
#include "item3d/io/image/png.h"

#include <algorithm>
#include <set>
#include <string>

namespace item3d {
namespace {

template <typename Vector>
std::span<const float> floats_of(const std::vector<Vector>& values) {
    static_assert(sizeof(Vector) % sizeof(float) == 0);
    return {reinterpret_cast<const float*>(values.data()),
            values.size() * sizeof(Vector) / sizeof(float)};
}

template <typename Vector>
Json list_of(const Vector& v) {
    Json list = Json::array();
    for (int c = 0; c < Vector::length(); ++c)
        list.push_back(v[c]);
    return list;
}

class GltfMaker {
  public:
    GltfMaker(const Model& model, const ModelEdit& edit)
        : model_(model), edit_(edit), builder_(json_, 0, {}, false, "") {}

    std::shared_ptr<SourceDocument> make() {
        json_["asset"] = Json{{"version", "2.0"}, {"generator", "item3d"}};
        json_["scene"] = 0;
        json_["scenes"] = Json::array({Json{{"nodes", Json::array()}}});
        for (std::size_t i = 0; i < model_.materials.size(); ++i)
            add_material(static_cast<int>(i));
        for (std::size_t i = 0; i < model_.primitives.size(); ++i)
            add_primitive(static_cast<int>(i));
        if (!extensions_used_.empty()) json_["extensionsUsed"] = extensions_used_;
        list_texture_extensions(json_);
        builder_.finish();
        auto document = std::make_shared<SourceDocument>();
        document->path = model_.name.empty() ? "model.glb" : model_.name + ".glb";
        document->json = std::move(json_);
        document->buffers.push_back(builder_.binary());
        document->has_binary_chunk = true;
        return document;
    }

  private:
    const MaterialEdit* edit_of(int material) const {
        const auto found = edit_.materials.find(material);
        return found == edit_.materials.end() ? nullptr : &found->second;
    }

    std::size_t texture(int index) {
        const auto found = textures_.find(index);
        if (found != textures_.end()) return found->second;
        const Texture& source = model_.textures[static_cast<std::size_t>(index)];
        int sampler = -1;
        if (source.wrap_u != Wrap::repeat || source.wrap_v != Wrap::repeat || source.nearest) {
            const auto number = [](Wrap wrap) {
                return wrap == Wrap::repeat ? 10497 : wrap == Wrap::mirrored_repeat ? 33648 : 33071;
            };
            Json modes{{"wrapS", number(source.wrap_u)}, {"wrapT", number(source.wrap_v)}};
            if (source.nearest) modes["magFilter"] = 9728;
            sampler = static_cast<int>(append(json_, "samplers", std::move(modes)));
        }
        const ImageEncoding encoding = source.file ? source.coding.encoding : ImageEncoding::png;
        return textures_[index] = builder_.add_texture(
                   source.file ? *source.file : encode_png(source.image, source.bits_per_channel),
                   encoding, source.name, sampler);
    }

    Json texture_info(int index, int uvs) {
        Json info{{"index", texture(index)}};
        if (uvs > 0) info["texCoord"] = uvs;
        return info;
    }

    // True if the texture exists and the edit does not replace it.
    bool wants(int index, bool is_edited) const {
        return index >= 0 && !is_edited &&
               !model_.textures[static_cast<std::size_t>(index)].image.empty();
    }

    void add_material(int index) {
        const Material& material = model_.materials[static_cast<std::size_t>(index)];
        const MaterialEdit* edit = edit_of(index);
        const bool new_orm = edit && edit->metallic_roughness;
        Json pbr{{"baseColorFactor", list_of(material.base_color_factor)}};
        if (wants(material.base_color_texture, edit && edit->base_color)) {
            pbr["baseColorTexture"] = Json{{"index", texture(material.base_color_texture)}};
        }
        pbr["metallicFactor"] = material.metallic_factor;
        pbr["roughnessFactor"] = material.roughness_factor;
        if (wants(material.metallic_roughness_texture, new_orm)) {
            pbr["metallicRoughnessTexture"] =
                texture_info(material.metallic_roughness_texture, material.metallic_roughness_uvs);
        }
        Json json = Json::object();
        if (!material.name.empty()) json["name"] = material.name;
        json["pbrMetallicRoughness"] = std::move(pbr);
        if (wants(material.normal_texture, edit && edit->normal)) {
            json["normalTexture"] = texture_info(material.normal_texture, material.normal_uvs);
            if (material.normal_scale != 1.0f)
                json["normalTexture"]["scale"] = material.normal_scale;
        }
        if (wants(material.occlusion_texture, new_orm)) {
            json["occlusionTexture"] =
                texture_info(material.occlusion_texture, material.occlusion_uvs);
            if (material.occlusion_strength != 1.0f) {
                json["occlusionTexture"]["strength"] = material.occlusion_strength;
            }
        }
        if (wants(material.emissive_texture, false)) {
            json["emissiveTexture"] =
                texture_info(material.emissive_texture, material.emissive_uvs);
        }
        if (material.emissive_factor != Vec3(0.0f)) {
            const float strength =
                std::max({1.0f, material.emissive_factor.x, material.emissive_factor.y,
                          material.emissive_factor.z});
            json["emissiveFactor"] = list_of(material.emissive_factor / strength);
            if (strength > 1.0f) {
                constexpr const char* name = "KHR_materials_emissive_strength";
                json["extensions"][name]["emissiveStrength"] = strength;
                extensions_used_.insert(name);
            }
        }
        if (material.alpha == Material::Alpha::blend) json["alphaMode"] = "BLEND";
        if (material.alpha == Material::Alpha::mask) {
            json["alphaMode"] = "MASK";
            json["alphaCutoff"] = material.alpha_cutoff;
        }
        if (material.double_sided) json["doubleSided"] = true;
        if (material.unlit && !edit) {
            json["extensions"]["KHR_materials_unlit"] = Json::object();
            extensions_used_.insert("KHR_materials_unlit");
        }
        append(json_, "materials", std::move(json));
    }

    bool has_textures_left(int index) const {
        const Material& material = model_.materials[static_cast<std::size_t>(index)];
        const MaterialEdit* edit = edit_of(index);
        const bool new_orm = edit && edit->metallic_roughness;
        return wants(material.base_color_texture, edit && edit->base_color) ||
               wants(material.metallic_roughness_texture, new_orm) ||
               wants(material.occlusion_texture, new_orm) ||
               wants(material.normal_texture, edit && edit->normal) ||
               wants(material.emissive_texture, false);
    }

    // Returns the texture coordinates of a primitive. If an edit replaces them and no texture uses
    // them any more, the result is empty.
    std::vector<Vec2> uvs_of(int index, const Primitive& primitive) const {
        const bool is_needed = has_textures_left(primitive.material);
        const bool is_first_of_many = !primitive.further_uvs.empty();
        if (edit_.primitives.contains(index) && !is_needed && !is_first_of_many) return {};
        if (primitive.uvs.empty() && (is_needed || is_first_of_many))
            return std::vector<Vec2>(primitive.positions.size());
        return primitive.uvs;
    }

    void add_primitive(int index) {
        const Primitive& primitive = model_.primitives[static_cast<std::size_t>(index)];
        ITEM3D_CHECK(static_cast<std::size_t>(primitive.material) < model_.materials.size(),
                     "primitive '" + primitive.name + "' refers to material " +
                         std::to_string(primitive.material));
        Json attributes{{"POSITION", builder_.add_floats(floats_of(primitive.positions), 3, true)}};
        if (!primitive.normals.empty()) {
            attributes["NORMAL"] = builder_.add_floats(floats_of(primitive.normals), 3);
        }
        if (!primitive.tangents.empty()) {
            attributes["TANGENT"] = builder_.add_floats(floats_of(primitive.tangents), 4);
        }
        if (const std::vector<Vec2> uvs = uvs_of(index, primitive); !uvs.empty()) {
            attributes["TEXCOORD_0"] = builder_.add_floats(floats_of(uvs), 2);
        }
        for (std::size_t k = 0; k < primitive.further_uvs.size(); ++k) {
            std::vector<Vec2> uvs = primitive.further_uvs[k];
            uvs.resize(primitive.positions.size(), Vec2(0.0f));
            attributes["TEXCOORD_" + std::to_string(k + 1)] =
                builder_.add_floats(floats_of(uvs), 2);
        }
        if (!primitive.colors.empty()) {
            std::vector<Vec4> colors = primitive.colors;
            for (Vec4& color : colors)
                color = glm::clamp(color, 0.0f, 1.0f);
            attributes["COLOR_0"] = builder_.add_floats(floats_of(colors), 4);
        }
        Json mesh = Json::object();
        Json node = Json::object();
        if (!primitive.name.empty()) mesh["name"] = node["name"] = primitive.name;
        mesh["primitives"] = Json::array(
            {Json{{"attributes", std::move(attributes)},
                  {"indices", builder_.add_indices(primitive.indices, primitive.positions.size())},
                  {"material", primitive.material}}});
        if (model_.origin != glm::dvec3(0.0)) node["translation"] = list_of(model_.origin);
        node["mesh"] = append(json_, "meshes", std::move(mesh));
        append(json_["scenes"][0], "nodes", append(json_, "nodes", std::move(node)));
    }

    const Model& model_;
    const ModelEdit& edit_;
    Json json_ = Json::object();
    GltfBuilder builder_;
    std::map<int, std::size_t> textures_;
    std::set<std::string> extensions_used_;
};

}  // namespace

std::shared_ptr<SourceDocument> make_gltf(const Model& model, const ModelEdit& edit) {
    return GltfMaker(model, edit).make();
}

}  // namespace item3d
