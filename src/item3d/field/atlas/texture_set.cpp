#include "item3d/field/atlas/texture_set.h"

#include <algorithm>
#include <tuple>

namespace item3d {
namespace {

bool show_the_same(const Material& a, const Material& b) {
    const auto shown = [](const Material& m) {
        return std::tuple(m.base_color_texture, m.metallic_roughness_texture,
                          m.metallic_roughness_uvs, m.occlusion_texture, m.occlusion_uvs,
                          m.normal_texture, m.normal_uvs, m.base_color_factor.x,
                          m.base_color_factor.y, m.base_color_factor.z, m.base_color_factor.w,
                          m.metallic_factor, m.roughness_factor, m.occlusion_strength,
                          m.normal_scale);
    };
    return shown(a) == shown(b);
}

}  // namespace

bool TextureSet::has(int material) const {
    return std::find(materials.begin(), materials.end(), material) != materials.end();
}

std::vector<int> textures_of(const Material& material) {
    std::vector<int> textures;
    for (const int index : {material.base_color_texture, material.metallic_roughness_texture,
                            material.occlusion_texture, material.normal_texture})
        if (index >= 0) textures.push_back(index);
    return textures;
}

bool have_uvs(const Model& model, const std::vector<int>& primitives) {
    return std::all_of(primitives.begin(), primitives.end(), [&](int index) {
        const Primitive& primitive = model.primitives[static_cast<std::size_t>(index)];
        return primitive.uvs.size() == primitive.positions.size();
    });
}

std::vector<TextureSet> texture_sets(const Model& model, const FieldSpace& space,
                                     const std::vector<int>& materials) {
    std::vector<TextureSet> sets;
    for (const int index : materials) {
        const Material& material = model.materials[static_cast<std::size_t>(index)];
        TextureSet own;
        own.materials = {index};
        for (std::size_t i = 0; i < model.primitives.size(); ++i) {
            if (model.primitives[i].material == index &&
                space.first_instance()[i] == static_cast<int>(i))
                own.primitives.push_back(static_cast<int>(i));
        }
        if (own.primitives.empty()) continue;
        const auto joins = [&](const TextureSet& set) {
            const int other = set.materials.front();
            return show_the_same(material, model.materials[static_cast<std::size_t>(other)]) &&
                   have_uvs(model, set.primitives);
        };
        const bool can_join = !textures_of(material).empty() && have_uvs(model, own.primitives);
        const auto found = can_join ? std::find_if(sets.begin(), sets.end(), joins) : sets.end();
        if (found == sets.end()) {
            sets.push_back(std::move(own));
            continue;
        }
        found->materials.push_back(index);
        found->primitives.insert(found->primitives.end(), own.primitives.begin(),
                                 own.primitives.end());
    }
    return sets;
}

std::string names_of(const Model& model, const TextureSet& set) {
    std::string names = set.materials.size() == 1 ? "material" : "materials";
    for (std::size_t i = 0; i < set.materials.size(); ++i)
        names += (i == 0 ? " '" : ", '") +
                 model.materials[static_cast<std::size_t>(set.materials[i])].name + "'";
    return names;
}

}  // namespace item3d
