#include "item3d/edit/scene.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/edit/memory.h"
#include "item3d/io/load.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/checkpoint.h"
#include "item3d/tensors/precision.h"

namespace item3d {
namespace {

// A prior that sees few pixels needs no fine reflections, and coarse ones prefilter in a moment.
constexpr int small_picture = 128;

std::shared_ptr<const Captioner> load_wanted_captioner(const EditRequest& request,
                                                       at::ScalarType precision) {
    if (!wants_captions(request.settings)) return nullptr;
    if (request.captioner.empty())
        throw InputError("--adjust " + request.settings.adjust,
                         "needs a captioner, and the prior "
                         "brings none",
                         "give a folder with BLIP or BLIP-2: --captioner DIR");
    return load_captioner(request.captioner, request.device, precision);
}

/// What of a scene the prior is loaded by.
struct PriorNeeds {
    at::Device device = at::kCPU;
    at::ScalarType precision = at::kFloat;
    bool any_sentence = false;  ///< some are not known yet: a captioner will say them
    bool low_memory = false;
    std::string from, to;  ///< as the prior reads them
};

std::shared_ptr<DiffusionModel> load_networks(const EditRequest& request,
                                              const PriorNeeds& prior_needs) {
    const EditSettings& settings = request.settings;
    if (prior_needs.any_sentence) {
        auto prior = std::make_shared<Pipeline>(
            Pipeline::load(request.prior, prior_needs.device, prior_needs.precision));
        prior->add(settings);
        return prior;
    }
    RunNeeds needs;
    needs.prompts = {prior_needs.from, prior_needs.to, settings.negative_prompt,
                     default_negative_prompt()};
    needs.decoder = wants_detail(settings);
    return std::make_shared<RunningPipeline>(RunningPipeline::load(
        request.prior, prior_needs.device, prior_needs.precision, settings, needs));
}

std::shared_ptr<const DiffusionModel> load_prior(const EditRequest& request,
                                                 const PriorNeeds& needs) {
    const auto prior = load_networks(request, needs);
    const EditSettings& settings = request.settings;
    for (const auto& [option, text] :
         {std::pair("--from", settings.from), std::pair("--to", settings.to)})
        warn_of_lost_words(prior->tokenizer(), option, text);
    if (needs.low_memory) prior->recompute_in_backward(true);
    return prior;
}

}  // namespace

EditScene load_scene(const EditRequest& request) {
    const at::Device device = request.device;
    const EditSettings& settings = request.settings;

    EditScene scene;
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    scene.from = vocabulary.reading(settings.from);
    scene.to = vocabulary.reading(settings.to);
    scene.device = device;
    scene.precision = choose_precision(request.precision, device);
    const bool low_memory = wants_low_memory(request, scene.precision, device);
    scene.captioner = load_wanted_captioner(request, scene.precision);
    scene.loading_prior = std::async(std::launch::async, load_prior, request,
                                     PriorNeeds{device, scene.precision, scene.captioner != nullptr,
                                                low_memory, scene.from, scene.to})
                              .share();
    scene.hashing_weights = std::async(std::launch::async, hash_of_weights, request.prior).share();
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
    return scene;
}

}  // namespace item3d
