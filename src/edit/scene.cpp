#include "item3d/edit/scene.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/edit/memory.h"
#include "item3d/models/precision.h"
#include "item3d/scene/io/load.h"

namespace item3d {
namespace {

// A prior that sees few pixels needs no fine reflections, and coarse ones prefilter in a moment.
constexpr int small_picture = 128;

std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       torch::Dtype precision) {
    if (!wants_captions(request.settings)) return nullptr;
    if (request.captioner.empty())
        throw InputError("--adjust " + request.settings.adjust,
                         "needs a captioner, and the prior "
                         "brings none",
                         "give a folder with BLIP or BLIP-2: --captioner DIR");
    return load_captioner(request.captioner, request.device, precision);
}

Pipeline load_prior(const EditRequest& request, const EditScene& scene) {
    const EditSettings& settings = request.settings;
    if (scene.captioner) {  // whose sentences are not known yet
        Pipeline prior = Pipeline::load(request.prior, scene.device, scene.precision);
        apply_extras(prior, settings);
        return prior;
    }
    RunNeeds needs;
    needs.prompts = {settings.from, settings.to, settings.negative_prompt,
                     default_negative_prompt()};
    needs.decoder = wants_detail(settings);
    return load_to_run(request.prior, scene.device, scene.precision, settings, needs);
}

}  // namespace

EditScene load_scene(const EditRequest& request) {
    const torch::Device device = request.device;
    const EditSettings& settings = request.settings;

    EditScene scene;
    scene.device = device;
    scene.precision = choose_precision(request.precision, device);
    const bool low_memory = wants_low_memory(request, scene.precision, device);
    scene.captioner = load_wanted_captioner(request, scene.precision);
    scene.model = load_model(request.model);
    scene.materials = select_materials(scene.model, settings.material);
    for (const int index : scene.materials) {
        Material& material = scene.model.materials[static_cast<std::size_t>(index)];
        if (material.unlit)
            note("material '" + material.name + "' is unlit; edited, it is a surface in light");
        material.unlit = false;
    }
    scene.channels = edited_channels(settings);
    scene.geometry = Geometry::from_model(scene.model, device);
    scene.sphere = bounding_sphere(scene.model);
    scene.space = std::make_unique<FieldSpace>(scene.model, scene.materials, device);
    if (edits_texture(settings))
        scene.atlas = make_atlas(scene.model, *scene.space, scene.materials, settings.texture_size);
    scene.textured = std::make_unique<TexturedMaterials>(scene.model, device);
    scene.source = std::make_unique<MaterialSource>(scene.model, *scene.textured, *scene.space,
                                                    scene.materials, scene.channels, device);
    // A light that is optimised is the only one.
    scene.lights = std::make_unique<LightRig>(
        settings.light, edits_light(settings) ? "off" : settings.light_augment,
        settings.resolution <= small_picture ? 64 : 256, device);
    scene.prior = std::make_shared<Pipeline>(load_prior(request, scene));
    for (const auto& [option, text] :
         {std::pair("--from", settings.from), std::pair("--to", settings.to)})
        warn_of_lost_words(*scene.prior->tokenizer, option, text);
    if (low_memory) scene.prior->vae->recompute_in_backward(true);
    return scene;
}

}  // namespace item3d
