#include "item3d/edit/optimize/optimize.h"

#include "item3d/core/error.h"
#include "item3d/core/failed_steps.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/optimize/adjustment.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/checkpoint_writer.h"
#include "item3d/edit/optimize/color_regularizer.h"
#include "item3d/edit/optimize/convergence.h"
#include "item3d/edit/optimize/method_guidance.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/processes/gradients.h"
#include "item3d/render/scatter.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int warm_up_iterations = 10;
constexpr float final_learning_rate = 0.1f;  ///< relative to the initial one
constexpr std::int64_t cool_down = 20;       ///< iterations after convergence

/// Returns the factor of the learning rate. The factor rises in a warm-up, and then falls along a
/// cosine to 0.1.
float scheduled_learning_rate(std::int64_t iteration, std::int64_t iterations) {
    const float warm_up =
        std::min(1.0f, static_cast<float>(iteration + 1) / static_cast<float>(warm_up_iterations));
    const float progress = static_cast<float>(iteration) / static_cast<float>(iterations);
    const float cosine = 0.5f + 0.5f * std::cos(pi * progress);
    return warm_up * (final_learning_rate + (1 - final_learning_rate) * cosine);
}

/// Returns the iteration of convergence, if any. Only an edit with the uniform timestep schedule
/// can converge; if the noise level falls, the direction's length changes without convergence.
std::optional<std::int64_t> converged(const EditPlan& plan, const EditState& state) {
    if (plan.timestep_schedule != TimestepSchedule::uniform) return std::nullopt;
    return converged_at(state.direction_length, plan.settle);
}

/// Returns the factor of the settings' learning rate. It depends only on the iteration and the
/// iteration of convergence, so that a resumed run takes the same course. After convergence the
/// factor decays as at the end of a full run, because large steps leave noise.
float learning_rate_factor(const EditPlan& plan, const EditState& state) {
    const float scheduled = scheduled_learning_rate(state.iteration, plan.iterations);
    const auto since = converged(plan, state);
    if (!since) return scheduled;
    const float part = static_cast<float>(state.iteration - *since) / cool_down;
    return scheduled + part * (final_learning_rate - scheduled);
}

/// Counts the iterations that convergence makes unnecessary as done.
void end_where_converged(const EditPlan& plan, EditState& state) {
    const auto since = converged(plan, state);
    if (!since || state.iteration < *since + cool_down || state.iteration >= plan.iterations)
        return;
    note(fmt::format("converged after {} of {} iterations", state.iteration, plan.iterations));
    state.iteration = plan.iterations;
}

GBuffer rasterize_iteration(const EditScene& scene, const EditPlan& plan, std::int64_t iteration,
                            const Share& views) {
    std::vector<Camera> cameras = cameras_of_method(scene, plan, iteration);
    const bool is_fixed = plan.method == "in2n";
    if (scene.region_views && !is_fixed)
        scene.region_views->take_turns(cameras, plan.seed, iteration);
    const auto first = cameras.begin() + views.first;
    return rasterize_views(scene, plan, {first, first + views.count});
}

/// Returns [N, 1, h, w]: 1 for latents that contain a pixel of the region or lie beside one, else
/// 0.
at::Tensor edited_latents(const GBuffer& gbuffer, const at::Tensor& latents) {
    const at::Tensor pixels = scatter(gbuffer.own.edited, gbuffer.surface, gbuffer.raster,
                                      at::zeros({1}, gbuffer.own.edited.options()))
                                  .permute({0, 3, 1, 2});
    const at::Tensor covered = at::adaptive_avg_pool2d(pixels, {latents.size(2), latents.size(3)});
    return at::max_pool2d(covered, {3, 3}, {1, 1}, {1, 1}).gt(0).to(latents.dtype());
}

SeenShape narrow(const SeenShape& shape, const Share& views) {
    const auto rows = [&](const at::Tensor& all) {
        return all.defined() ? all.narrow(0, views.first, views.count) : all;
    };
    return {rows(shape.depth), rows(shape.position), rows(shape.normal)};
}

/// The images of an iteration that this process renders, and the part that it hands to guidance.
struct IterationImages {
    ViewShare views;
    GBuffer gbuffer;    ///< of the views views.drawn()
    at::Tensor images;  ///< of the same views
    GuidanceInput input;
};

/// Renders the images of an iteration. Their reference images show the fitted field and not the
/// model's textures, so that an unedited field renders exactly the reference.
IterationImages draw_iteration(const EditRequest& request, const EditScene& scene,
                               EditState& state) {
    const EditPlan& plan = request.plan;
    IterationImages images;
    images.views = share_views(request.processes, plan.batch);
    const Share drawn = images.views.drawn();
    images.gbuffer = rasterize_iteration(scene, plan, state.iteration, drawn);
    ViewOptions options{state.iteration};
    options.first_view = static_cast<int>(drawn.first);
    options.total_views = plan.batch;
    if (images.views.by_points) options.processes = request.processes;
    EnvironmentLight light;
    if (state.light) {
        light = prefilter_light(scene, *state.light);
        options.light = &light;
    }
    const Share own{images.views.own.first - drawn.first, images.views.own.count};
    const auto draw = [&](NeuralTexture& field) {
        return render_view(scene, plan, field, images.gbuffer, options).images;
    };
    images.images = draw(state.field);
    GuidanceInput& input = images.input;
    input.images = images.images.narrow(0, own.first, own.count);
    input.shape = narrow(images.gbuffer.shape, own);
    input.processes = request.processes;
    input.first = images.views.own.first;
    input.total = plan.batch;
    if (state.guidance->needs_reference()) {
        const at::NoGradGuard no_grad;
        if (state.light) options.light = &state.first_light;
        input.reference = draw(state.fitted).narrow(0, own.first, own.count);
    }
    return images;
}

/// Propagates the gradients of all views to the parameters.
void backward(const EditRequest& request, const EditScene& scene,
              const ColorRegularizer& color_regularizer, const IterationImages& images,
              const GuidanceOutput& guidance, EditState& state) {
    const ProcessGroup& processes = request.processes;
    if (images.views.own.count > 0) {
        // An overflow of one prediction in bf16 must not destroy the field.
        at::Tensor gradient = at::nan_to_num(guidance.latents_gradient, 0.0, 0.0, 0.0);
        if (scene.region)
            gradient =
                gradient * edited_latents(images.gbuffer, gradient)
                               .narrow(0, images.views.own.first - images.views.drawn().first,
                                       gradient.size(0));
        guidance.latents.backward(gradient / request.plan.batch);
    } else {
        // This process has no image of its own, but it may have shaded points of other processes'
        // images. So it joins their backward pass with a gradient of 0.
        images.images.backward(at::zeros_like(images.images));
    }
    color_regularizer.backward(processes, state);
    // Only the last process, which may have no image, adds the light's regularisation.
    if (state.light && processes.rank() + 1 == processes.size())
        state.light->regularization().backward();
    sum_gradients(processes, state.optimizer.parameters());
}

void set_learning_rates(const EditPlan& plan, EditState& state) {
    const float factor = learning_rate_factor(plan, state);
    if (plan.edits_texture)
        for (const char* group : {"table", "network"})
            state.optimizer.options(group).learning_rate = factor * plan.learning_rate;
    if (plan.edits_light)
        state.optimizer.options("light").learning_rate = factor * plan.light_learning_rate;
}

/// Throws InputError if so many predictions in a row are not finite that the edit cannot succeed.
/// images: the renders of the last iteration.
/// In half precision, single predictions can overflow; backward() then drops their gradients.
void check_prediction(const EditRequest& request, const at::Tensor& images, float direction_length,
                      FailedSteps& failed) {
    if (!failed.too_many_after(!std::isfinite(direction_length))) return;
    if (!images.isfinite().all().item<bool>())
        throw InputError(request.model.string(), "its renders have numbers that are not finite",
                         "look for extreme values in its materials and in the lights");
    const bool uses_clip = request.plan.method == "clip";
    const auto& teacher = request.teacher.empty() ? request.clip : request.teacher;
    throw InputError((uses_clip ? teacher : request.prior).string(),
                     fmt::format("its predictions in {} iterations in a row are not finite numbers",
                                 failed.limit()),
                     overflow_hint);
}

/// Appends the first process's numbers to the curves of all processes. Convergence must be the same
/// on all processes, and CPUs of different kinds round differently.
void record_step(const ProcessGroup& processes, const GuidanceOutput& guidance, EditState& state) {
    at::Tensor curves = at::zeros({2});
    if (processes.first()) curves = at::tensor({guidance.direction_length, guidance.source_loss});
    processes.sum(curves);
    state.direction_length.push_back(curves[0].item<float>());
    state.source_loss.push_back(curves[1].item<float>());
    ++state.iteration;
}

void run_iteration(const EditRequest& request, const EditScene& scene,
                   const ColorRegularizer& color_regularizer, EditState& state, FailedSteps& failed,
                   IterationTimes& times) {
    const EditPlan& plan = request.plan;
    const double exchanged = request.processes.exchange_seconds();
    const double start = seconds_now();
    const IterationImages images = draw_iteration(request, scene, state);
    const double rendered = seconds_now();
    const GuidanceOutput guidance = state.guidance->step(images.input, state.iteration);
    const double guided = seconds_now();
    backward(request, scene, color_regularizer, images, guidance, state);
    const double back = seconds_now();

    set_learning_rates(plan, state);
    record_step(request.processes, guidance, state);
    check_prediction(request, images.images, state.direction_length.back(), failed);
    state.optimizer.step();
    state.optimizer.zero_grad();

    ++times.iterations;
    times.render += rendered - start;
    times.encode += guidance.seconds_encode;
    times.unet += guidance.seconds_unet;
    times.backward += back - guided;
    times.step += seconds_now() - back;
    times.exchange += request.processes.exchange_seconds() - exchanged;
}

}  // namespace

IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state) {
    const EditPlan& plan = request.plan;
    IterationTimes times;
    const DirectionAdjustment adjustment(request, scene);
    const ColorRegularizer color_regularizer(scene, plan, state);
    const auto adjust = [&](const auto& step) {
        const double start = seconds_now();
        try {
            step();
        } catch (const Interrupted&) {  // thrown while a caption is computed
            interrupt(request, state);
        }
        times.adjust += seconds_now() - start;
    };
    if (state.iteration < plan.iterations) {
        Progress progress("edit", plan.iterations, state.iteration);
        CheckpointWriter checkpoints(request, scene, state.fitted);
        FailedSteps failed(std::min<std::int64_t>(10, plan.iterations));
        while (state.iteration < plan.iterations) {
            adjust([&] { adjustment.before_iteration(state); });
            run_iteration(request, scene, color_regularizer, state, failed, times);
            end_where_converged(plan, state);
            progress.update(state.iteration,
                            fmt::format("direction {:.3f}", state.direction_length.back()));
            checkpoints.after_step(state, progress);
        }
    }
    adjust([&] { adjustment.finish(state); });
    save_state(request, state);
    return times;
}

}  // namespace item3d
