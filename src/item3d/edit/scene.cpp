#include "item3d/edit/scene.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/outputs/bake_options.h"
#include "item3d/edit/region_choice.h"
#include "item3d/field/atlas/shared_texels.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/region/region_readers.h"
#include "item3d/scene/visibility.h"
#include "item3d/tensors/precision.h"

#include <algorithm>

namespace item3d {

namespace {

/// Throws InputError if the edited part is invisible, or if one of its base-colour images cannot be
/// used.
void check_looks(const EditRequest& request, const Model& model,
                 const std::vector<int>& materials) {
    if (!is_visible(model, materials)) {
        throw InputError(
            request.model.string(),
            "the part to edit is invisible: it is fully transparent, or its triangles have no area",
            "give its materials an opacity above 0");
    }
    if (request.allow_missing_textures) return;
    for (const int index : materials) {
        const Material& material = model.materials[static_cast<std::size_t>(index)];
        if (material.missing_base_color.empty()) continue;
        throw InputError(request.model.string(),
                         "the base colour '" + material.missing_base_color + "' of material '" +
                             material.name + "' cannot be used (see the warning)",
                         "fix the file, give its folder with --textures, or edit without it with "
                         "--allow-missing-textures");
    }
}

void note_variants(const Model& model, const std::vector<int>& materials) {
    if (model.variants.empty()) return;
    const std::vector<std::string> changed = variants_with(model, materials, true);
    const std::vector<std::string> left = variants_with(model, materials, false);
    note(fmt::format("variants that change: {}; unchanged variants: {}",
                     changed.empty() ? "none" : fmt::format("{}", fmt::join(changed, ", ")),
                     left.empty() ? "none" : fmt::format("{}", fmt::join(left, ", "))));
}

}  // namespace

EditScene load_scene(const EditRequest& request) {
    EditSession session;
    return load_scene(request, session);
}

EditScene load_scene(const EditRequest& request, EditSession& session) {
    const at::Device device = request.device;
    const EditPlan& plan = request.plan;

    EditScene scene;
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    scene.from = vocabulary.reading(plan.from);
    scene.to = vocabulary.reading(plan.to);
    scene.device = device;
    scene.precision = choose_precision(request.precision, device);
    PriorUse use{device, scene.precision, false};
    use.low_memory =
        wants_low_memory(request, scene.precision, device, session.has_prior(request, use));
    scene.captioner = session.captioner(request, scene.precision);
    scene.loading_prior = session.prior(request, use);
    scene.hashing_weights = session.prior_hash(request.prior);
    scene.model = session.take_model(request);
    scene.materials = select_materials(scene.model, plan.material);
    check_looks(request, scene.model, scene.materials);
    scene.geometry = Geometry::from_model(scene.model, device);
    scene.sphere = bounding_sphere(scene.model);
    if (plan.edits_texture) choose_region(request, vocabulary, scene);
    scene.file_materials = scene.model.materials;
    scene.losses = prepare_materials(scene.model, scene.materials, plan);
    if (plan.edits_texture) note_variants(scene.model, scene.materials);
    scene.start = choose_start(plan, vocabulary, scene.model, scene.materials);
    scene.space = std::make_unique<FieldSpace>(scene.model, scene.materials, device);
    if (plan.edits_texture) {
        scene.atlas = choose_uvs(scene.model, *scene.space, scene.materials, baked_uvs(plan));
        if (scene.atlas.has_shared_texels())
            scene.space->share(std::make_shared<SharedTexels>(scene.model, scene.atlas,
                                                              plan.texture_size, device));
    }
    scene.is_prepared =
        std::any_of(scene.losses.begin(), scene.losses.end(), [](const auto& entry) {
            const MaterialLosses& lost = entry.second;
            return lost.emission || lost.transparency || !lost.extensions.empty();
        });
    // Reuses the textures that were loaded for the region, unless prepare_materials() changed the
    // model.
    scene.textured = scene.source_textures && !scene.is_prepared
                         ? std::make_unique<TexturedMaterials>(*scene.source_textures)
                         : std::make_unique<TexturedMaterials>(scene.model, device);
    scene.source = std::make_unique<MaterialSource>(scene.model, *scene.textured, *scene.space,
                                                    scene.materials, scene.start.channels,
                                                    scene.region.get(), device);
    scene.lights = session.lights(plan, device);
    return scene;
}

void EditScene::release_textures() {
    if (region) return;
    source.reset();
    textured.reset();
}

std::future<Atlas> unwrap_meanwhile(const EditRequest& request, const EditScene& scene) {
    return std::async(std::launch::async, [&request, &scene, atlas = scene.atlas]() mutable {
        add_new_uvs(scene.model, *scene.space, request.plan.texture_size, atlas);
        return std::move(atlas);
    });
}

}  // namespace item3d
