#include "item3d/edit/source_materials.h"

#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace item3d {
namespace {

// All lists are sorted.
constexpr std::array<std::string_view, 24> cloth_words = {
    "canvas", "carpet",  "cashmere", "cloth",   "corduroy", "cotton",  "denim",  "fabric",
    "felt",   "flannel", "fleece",   "jersey",  "knit",     "knitted", "linen",  "plush",
    "satin",  "silk",    "suede",    "textile", "tweed",    "velour",  "velvet", "wool"};
constexpr std::array<std::string_view, 50> opaque_words = {
    "asphalt",   "bamboo",   "bark",       "bone",      "bread",       "brick",     "bricks",
    "cardboard", "cement",   "ceramic",    "charcoal",  "cheese",      "chocolate", "clay",
    "coal",      "concrete", "cork",       "earth",     "earthenware", "fur",       "granite",
    "graphite",  "ivory",    "leather",    "limestone", "marble",      "moss",      "mossy",
    "mud",       "oak",      "obsidian",   "paper",     "pine",        "plaster",   "porcelain",
    "rock",      "rubber",   "sand",       "sandstone", "slate",       "soil",      "stone",
    "straw",     "stucco",   "terracotta", "walnut",    "wicker",      "wood",      "wooden",
    "woollen"};
constexpr std::array<std::string_view, 18> clear_words = {
    "amber",  "clear",  "crystal",  "diamond",     "emerald",     "gem",
    "glass",  "glassy", "ice",      "icy",         "jelly",       "liquid",
    "quartz", "ruby",   "sapphire", "translucent", "transparent", "water"};
constexpr std::array<std::string_view, 5> light_through = {
    "KHR_materials_diffuse_transmission", "KHR_materials_dispersion", "KHR_materials_transmission",
    "KHR_materials_volume", "KHR_materials_volume_scatter"};
constexpr std::array<std::string_view, 4> shown_on_top = {
    "KHR_materials_clearcoat", "KHR_materials_iridescence", "KHR_materials_sheen",
    "KHR_materials_specular"};

template <std::size_t N>
bool is_among(const std::array<std::string_view, N>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Properties of the material that the target sentence names.
struct TargetWords {
    bool metal, cloth, opaque, clear;

    explicit TargetWords(const std::string& to) : metal(names_metal(to)) {
        const std::vector<std::string> words = prompt_words(to);
        const auto any = [&](const auto& list) {
            return std::any_of(words.begin(), words.end(),
                               [&](const std::string& word) { return is_among(list, word); });
        };
        cloth = any(cloth_words);
        clear = any(clear_words);
        opaque = metal || cloth || any(opaque_words);
    }
    bool lets_no_light_through() const { return opaque && !clear; }
    bool has_no_sheen() const { return opaque && !cloth; }
};

bool is_same_image(const Model& model, int a, int b) {
    if (a < 0 || b < 0) return false;
    if (a == b) return true;
    const Image& first = model.textures[static_cast<std::size_t>(a)].image;
    const Image& second = model.textures[static_cast<std::size_t>(b)].image;
    return !first.empty() && first.width == second.width && first.height == second.height &&
           first.channels == second.channels && first.pixels == second.pixels;
}

float brightest(const Vec3& color) {
    return std::max({color.x, color.y, color.z});
}

void clear_emission(Material& material) {
    material.emissive_factor = Vec3(0.0f);
    material.emissive_texture = -1;
}

/// Returns true if the material's emission is removed.
bool settle_emission(const Model& model, Material& material) {
    constexpr float black = 0.01f;
    const std::string name = "material '" + material.name + "'";
    if (material.unlit) {
        note(name + " is unlit; the edit makes it a lit surface");
        material.unlit = false;
        clear_emission(material);
        return true;
    }
    if (brightest(material.emissive_factor) <= 0.0f) return false;
    const bool same_place = material.emissive_uvs == 0;
    if (same_place &&
        is_same_image(model, material.base_color_texture, material.emissive_texture)) {
        note(name + " emits its base colour; the edit makes it a lit surface");
        clear_emission(material);
        return true;
    }
    if (same_place && brightest(Vec3(material.base_color_factor)) <= black) {
        note(name + " only shows its emission; the edit makes the emission its base colour");
        material.base_color_texture = material.emissive_texture;
        material.base_color_factor =
            Vec4(glm::clamp(material.emissive_factor, 0.0f, 1.0f), material.base_color_factor.w);
        if (material.metallic_roughness_texture < 0) material.metallic_factor = 0.0f;
        clear_emission(material);
        return true;
    }
    warn(name + " has a separate emission, which is not edited");
    return false;
}

/// Returns true if the material becomes opaque.
bool settle_alpha(const Model& model, const TargetWords& words, Material& material) {
    const int texture = material.base_color_texture;
    const bool has_alpha_texels =
        texture >= 0 && model.textures[static_cast<std::size_t>(texture)].image.channels % 2 == 0;
    if (material.alpha != Material::Alpha::blend || material.base_color_factor.w >= 1.0f ||
        has_alpha_texels)
        return false;
    if (!words.lets_no_light_through()) {
        if (!words.clear) warn("material '" + material.name + "' keeps its transparency");
        return false;
    }
    note("material '" + material.name + "' becomes opaque");
    material.alpha = Material::Alpha::opaque;
    material.base_color_factor.w = 1.0f;
    return true;
}

std::vector<std::string> settle_extensions(const TargetWords& words, const Material& material) {
    std::vector<std::string> removed, kept;
    for (const std::string& name : material.other_extensions) {
        const bool passes_light = is_among(light_through, name);
        const bool sheen = name == "KHR_materials_sheen";
        if ((passes_light && words.lets_no_light_through()) || (sheen && words.has_no_sheen()))
            removed.push_back(name);
        else if ((passes_light && (!words.clear || words.opaque)) ||
                 (!passes_light && is_among(shown_on_top, name) && !(sheen && words.cloth)))
            kept.push_back(name);
    }
    if (!removed.empty())
        note(fmt::format("material '{}' loses {}, which contradicts the target", material.name,
                         fmt::join(removed, ", ")));
    if (!kept.empty())
        warn(fmt::format("material '{}' keeps {}, which {} neither edited nor rendered here",
                         material.name, fmt::join(kept, ", "), kept.size() > 1 ? "are" : "is"));
    return removed;
}

}  // namespace

std::map<int, MaterialLosses> prepare_materials(Model& model, const std::vector<int>& materials,
                                                const EditPlan& plan) {
    const TargetWords words(plan.to);
    std::map<int, MaterialLosses> losses;
    for (const int index : materials) {
        Material& material = model.materials[static_cast<std::size_t>(index)];
        MaterialLosses& lost = losses[index];
        if (plan.edits_texture && plan.channels.base_color) {
            lost.extensions = settle_extensions(words, material);
            lost.transparency = settle_alpha(model, words, material);
            lost.emission = settle_emission(model, material);
        } else if (material.unlit) {
            lost.emission = settle_emission(model, material);
        }
    }
    return losses;
}

void apply_losses(const std::map<int, MaterialLosses>& losses, ModelEdit& edit) {
    for (const auto& [index, lost] : losses) {
        const auto found = edit.materials.find(index);
        if (found == edit.materials.end()) continue;
        found->second.removes_emission = lost.emission;
        found->second.makes_opaque = lost.transparency;
        found->second.removed_extensions = lost.extensions;
    }
}

std::vector<std::string> variants_with(const Model& model, const std::vector<int>& materials,
                                       bool with) {
    std::vector<std::string> names;
    for (const MaterialVariant& variant : model.variants) {
        const bool has =
            std::any_of(variant.materials.begin(), variant.materials.end(), [&](int material) {
                return std::find(materials.begin(), materials.end(), material) != materials.end();
            });
        if (has == with) names.push_back(variant.name);
    }
    return names;
}

}  // namespace item3d
