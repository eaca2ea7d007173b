#include "item3d/edit/material_start.h"

#include "item3d/edit/material_source.h"

#include <algorithm>

namespace item3d {
namespace {

/// Roughness of metals that the vocabulary lacks.
constexpr float usual_metal_roughness = 0.25f;
/// Smallest mean metallic at which a model counts as metal.
constexpr float half_metal = 0.5f;

bool is_kept(const EditPlan& plan, const char* channel) {
    return std::find(plan.keep.begin(), plan.keep.end(), channel) != plan.keep.end();
}

bool is_metal(const KnownWord& word) {
    return word.roughness.has_value();
}

/// True if the prompt names a non-metal, such as wood.
bool names_other_material(const PriorVocabulary& vocabulary, const std::string& prompt) {
    const std::vector<KnownWord> named = vocabulary.named("materials", prompt);
    return std::any_of(named.begin(), named.end(),
                       [](const KnownWord& word) { return !is_metal(word); });
}

/// Returns the prompt before " with ": "a red mug" of "a red mug with a golden handle".
std::string without_parts(const std::string& prompt) {
    return prompt.substr(0, prompt.find(" with "));
}

/// Returns the roughness of a metal that the target names for the whole object and that the source
/// does not name. Returns no value if there is no such metal.
std::optional<float> new_metal_roughness(const PriorVocabulary& vocabulary, const EditPlan& plan) {
    const std::string whole = without_parts(plan.to);
    if (!names_metal(whole)) return std::nullopt;
    const std::vector<KnownWord> before = vocabulary.named("materials", plan.from);
    for (const KnownWord& word : vocabulary.named("materials", whole)) {
        const bool is_new = std::none_of(before.begin(), before.end(),
                                         [&](const KnownWord& w) { return w.word == word.word; });
        if (is_metal(word)) return is_new ? word.roughness : std::nullopt;
    }
    return names_metal(plan.from) ? std::nullopt : std::optional(usual_metal_roughness);
}

}  // namespace

bool has_default_metal(const Material& material) {
    return material.metallic_roughness_texture < 0 && material.metallic_factor == 1.0f &&
           material.roughness_factor == 1.0f;
}

MaterialStart choose_start(const EditPlan& plan, const PriorVocabulary& vocabulary,
                           const Model& model, const std::vector<int>& materials) {
    MaterialStart start;
    start.channels = plan.channels;
    if (!plan.edits_texture || plan.iterations == 0) return start;
    const bool to_metal = names_metal(plan.to);
    const bool nobody_chose = std::all_of(materials.begin(), materials.end(), [&](int index) {
        return has_default_metal(model.materials[static_cast<std::size_t>(index)]);
    });
    const auto is_metal_now = [&] { return surface_means(model, materials).metallic > half_metal; };
    const bool leaves_metal =
        !to_metal && (names_metal(plan.from) || nobody_chose ||
                      (names_other_material(vocabulary, plan.to) && is_metal_now()));
    if (!is_kept(plan, "metallic")) {
        start.channels.metallic = start.channels.metallic || leaves_metal;
        if (leaves_metal) start.metallic = 1 - plan.metallic_start;
        if (to_metal && (!names_metal(plan.from) || !is_metal_now()))
            start.metallic = plan.metallic_start;
    }
    if (to_metal && !is_kept(plan, "roughness"))
        start.roughness = new_metal_roughness(vocabulary, plan);
    return start;
}

}  // namespace item3d
