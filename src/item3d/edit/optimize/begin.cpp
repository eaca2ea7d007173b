#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/metals.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/surface_means.h"
#include "item3d/field/fit.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr int small_prior = 128;  ///< pixels; one that sees fewer says little about a light

// AdamW's settings of the published code (betas 0.9 and 0.99), without weight decay: decay would
// pull an untouched texture towards grey.
AdamOptions adam_options(const EditSettings& settings) {
    AdamOptions options;
    options.learning_rate = settings.learning_rate;
    return options;
}

/// [table rows] What the learning rate of a level of the field's grid is multiplied by. Cells finer
/// than the prior's pixels get no say from it, only noise, which Adam would make as large as any
/// other step.
at::Tensor level_factors(const NeuralTexture& field, int resolution) {
    const at::Tensor factors = at::ones({field->grid().entries()});
    for (const HashGridLevel& level : field->grid().levels) {
        const float pixels_a_cell =
            static_cast<float>(resolution) / static_cast<float>(level.resolution);
        factors
            .narrow(0, static_cast<std::int64_t>(level.first),
                    static_cast<std::int64_t>(level.entries))
            .fill_(std::min(1.0f, pixels_a_cell));
    }
    return factors.to(field->table().device());
}

int finest_texture(const EditScene& scene, int texture_size) {
    int finest = 0;
    for (const int material : scene.materials) {
        const auto [width, height] = atlas_size(scene.model, material, texture_size);
        finest = std::max({finest, width, height});
    }
    return finest;
}

std::unique_ptr<LightModel> begin_light(const EditScene& scene, const EditSettings& settings) {
    LightModelOptions options;
    options.kind = settings.light_model;
    if (options.kind == "auto")
        options.kind = settings.resolution <= small_prior ? "physical" : "texels";
    if (!settings.light_from.empty())
        options.from = SkyAngles{settings.light_from[0], settings.light_from[1]};
    options.object_color = surface_means(scene.model, scene.materials).base_color;
    return make_light_model(load_light(settings.light), options);
}

/// Makes the field look like the input, with metallic where an edit towards or from metal starts.
void fit_field(const EditScene& scene, const EditSettings& settings, EditState& state) {
    FitOptions options;
    options.steps = settings.fit_steps;
    options.seed = settings.seed;
    fit_to_materials(state.field, scene.geometry, *scene.space, *scene.textured, options);
    state.fitted = snapshot(state.field);
    if (scene.channels.metallic && settings.iterations > 0 &&
        crosses_metallic(settings.from, settings.to)) {
        const float start = settings.metallic_start;
        shift_metallic(state.field, scene.geometry, *scene.space,
                       names_metal(settings.to) ? start : 1 - start);
    }
}

}  // namespace

EditState begin_or_resume(const EditRequest& request, const EditScene& scene) {
    const EditSettings& settings = request.settings;
    EditState state;
    state.field = NeuralTexture(suggest_field_options(
        scene.geometry, *scene.space, finest_texture(scene, settings.texture_size), settings.seed));
    state.field->to(scene.device);
    if (edits_texture(settings)) {
        AdamOptions table_options = adam_options(settings);
        table_options.row_factors = level_factors(state.field, settings.resolution);
        state.optimizer.add_group({state.field->table()}, table_options);
        state.optimizer.add_group(state.field->network_parameters(), adam_options(settings));
    }
    if (edits_light(settings)) {
        state.light = begin_light(scene, settings);
        const at::NoGradGuard no_grad;
        state.first_light = prefilter(state.light->cube(optimized_light_size).to(scene.device));
        state.optimizer.add_group(state.light->parameters(), adam_options(settings));
    }
    state.fitted = snapshot(state.field);
    const auto begin_guidance = [&] {
        state.guidance =
            make_guidance(scene.prior(), scene.from, scene.to, guidance_options(settings));
        state.prior_weights = scene.hashing_weights.get();
    };

    if (request.resume) {
        begin_guidance();
        if (load_state(request, state)) {
            note(fmt::format("resuming after iteration {} of {}", state.iteration,
                             total_iterations(settings)));
            return state;
        }
        note("nothing to resume in " + request.output.string() + ": beginning anew");
    }
    if (edits_texture(settings)) fit_field(scene, settings, state);
    if (!state.guidance) begin_guidance();  // the prior was loaded meanwhile
    if (edits_texture(settings)) save_state(request, state);
    return state;
}

}  // namespace item3d
