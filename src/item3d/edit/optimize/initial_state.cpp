#include "item3d/edit/optimize/initial_state.h"

#include "item3d/core/date.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/method_guidance.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/field/fit.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"

#include <algorithm>

namespace item3d {
namespace {

// Returns the settings of AdamW in the published code (betas 0.9 and 0.99), but without weight
// decay, which would pull an unchanged texture towards grey.
AdamOptions adam_options(const EditPlan& plan) {
    AdamOptions options;
    options.learning_rate = plan.learning_rate;
    return options;
}

/// Returns a factor of the learning rate for each row of the table of the field's grid; it depends
/// on the row's level. About cells finer than its pixels, the prior gives no information but only
/// noise, which Adam would scale up to full steps.
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

std::unique_ptr<LightModel> initial_light(const EditScene& scene, const EditPlan& plan) {
    LightModelOptions options;
    options.kind = plan.light_kind;
    if (!plan.light_from.empty()) options.from = SkyAngles{plan.light_from[0], plan.light_from[1]};
    options.object_color = surface_means(scene.model, scene.materials).base_color;
    return make_light_model(scene.lights->image(), options);
}

/// Fits the field on process 0 and broadcasts it, because the exchange of a step's gradients takes
/// longer than the step.
void fit_by_first(const EditRequest& request, const EditScene& scene, NeuralTexture& field) {
    const ProcessGroup& processes = request.processes;
    FitOptions options;
    options.steps = request.plan.fit_steps;
    options.seed = request.plan.seed;
    bool stopped = false;
    if (processes.first()) {
        try {
            fit_to_materials(field, scene.geometry, *scene.space, *scene.textured, options);
        } catch (const Interrupted&) {
            if (!processes.several()) throw;
            stopped = true;
        }
    }
    if (!processes.several()) return;
    if (processes.any(stopped || interrupted()))
        throw Interrupted("while fitting the neural texture");
    NamedTensors fitted;
    for (const auto& [name, tensor] : field->named_parameters())
        fitted.emplace_back(name, tensor.detach().cpu());
    fitted = processes.broadcast(fitted);
    const at::NoGradGuard no_grad;
    std::size_t next = 0;
    for (const auto& [name, tensor] : field->named_parameters())
        at::Tensor(tensor).copy_(fitted[next++].second);
}

/// Fits the field to the input, with the edit's initial metallic and roughness.
void fit_field(const EditRequest& request, const EditScene& scene, EditState& state) {
    fit_by_first(request, scene, state.field);
    state.fitted = snapshot(state.field);
    const auto begin_at = [&](OrmChannel channel, std::optional<float> mean) {
        if (mean) shift_mean(state.field, scene.geometry, *scene.space, channel, *mean);
    };
    begin_at(OrmChannel::metallic, scene.start.metallic);
    begin_at(OrmChannel::roughness, scene.start.roughness);
}

}  // namespace

EditState begin_or_resume(const EditRequest& request, const EditScene& scene) {
    const EditPlan& plan = request.plan;
    EditState state;
    require_one_request(request, state);
    state.begun = utc_date();
    state.field = NeuralTexture(suggest_field_options(
        scene.geometry, *scene.space, finest_texture(scene, plan.texture_size), plan.seed));
    state.field->to(scene.device);
    if (plan.edits_texture) {
        AdamOptions table_options = adam_options(plan);
        table_options.row_factors = level_factors(state.field, plan.resolution);
        state.optimizer.add_group("table", {state.field->table()}, table_options);
        state.optimizer.add_group("network", state.field->network_parameters(), adam_options(plan));
    }
    if (plan.edits_light) {
        state.light = initial_light(scene, plan);
        state.first_light = current_light(scene, state);
        state.optimizer.add_group("light", state.light->parameters(), adam_options(plan));
    }
    state.fitted = snapshot(state.field);
    const auto begin_guidance = [&] {
        state.guidance = guidance_of_method(request, scene);
        state.prior_weights = scene.hashing_weights.get();
        state.networks = {scene.prior()};
        require_one_request(request, state);
    };

    if (request.resume) {
        begin_guidance();
        if (load_state(request, state)) {
            note(fmt::format("resuming after iteration {} of {}", state.iteration,
                             plan.total_iterations));
            return state;
        }
        note("no checkpoint in " + request.output.string() + ": starting from the beginning");
    }
    // If a network is missing, this throws before the fit, which takes seconds.
    if (!state.guidance && plan.method != "item3d") begin_guidance();
    if (plan.edits_texture) fit_field(request, scene, state);
    if (!state.guidance) begin_guidance();  // the prior has loaded meanwhile
    if (plan.edits_texture) save_state(request, state);
    return state;
}

}  // namespace item3d
