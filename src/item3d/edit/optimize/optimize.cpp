#include "item3d/edit/optimize/optimize.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/optimize/adjustment.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/checkpoint_writer.h"
#include "item3d/edit/optimize/color_regularizer.h"
#include "item3d/edit/optimize/convergence.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/guidance/noised_latents.h"

#include <cmath>

namespace item3d {
namespace {

constexpr int warm_up_iterations = 10;
constexpr float final_learning_rate = 0.1f;  ///< as a part of the first
constexpr std::int64_t cool_down = 20;       ///< iterations that a settled edit still takes

/// Warm-up, then a cosine down to a tenth.
float scheduled_learning_rate(std::int64_t iteration, std::int64_t iterations) {
    const float warm_up =
        std::min(1.0f, static_cast<float>(iteration + 1) / static_cast<float>(warm_up_iterations));
    const float progress = static_cast<float>(iteration) / static_cast<float>(iterations);
    const float cosine = 0.5f + 0.5f * std::cos(pi * progress);
    return warm_up * (final_learning_rate + (1 - final_learning_rate) * cosine);
}

/// When the edit settled, if it has. Schedules in which noise levels fall change the direction's
/// length by themselves.
std::optional<std::int64_t> settled(const EditSettings& settings, const EditState& state) {
    if (settings.timestep_schedule != "uniform") return std::nullopt;
    return settled_at(state.direction_length, settings.settle);
}

/// As a part of the settings' learning rate: a function of the iteration and of when the edit
/// settled, so that a resumed run follows the same path. What has settled comes to rest as it would
/// have at the end: steps as large as in the middle leave noise.
float learning_rate_factor(const EditSettings& settings, const EditState& state) {
    const float scheduled = scheduled_learning_rate(state.iteration, settings.iterations);
    const auto since = settled(settings, state);
    if (!since) return scheduled;
    const float part = static_cast<float>(state.iteration - *since) / cool_down;
    return scheduled + part * (final_learning_rate - scheduled);
}

/// Counts as done what a settled edit is spared.
void end_where_settled(const EditSettings& settings, EditState& state) {
    const auto since = settled(settings, state);
    if (!since || state.iteration < *since + cool_down || state.iteration >= settings.iterations)
        return;
    note(fmt::format("settled after {} of {} iterations", state.iteration, settings.iterations));
    state.iteration = settings.iterations;
}

/// What guidance looks at. The unedited model is the field as it was fitted, so that a render that
/// has not been edited yet equals its reference.
GuidanceInput look(const EditScene& scene, const EditSettings& settings, EditState& state) {
    const SeenModel seen =
        see_model(scene, settings,
                  sample_cameras(scene.sphere, settings.batch, settings.seed, state.iteration));
    ViewOptions options{state.iteration};
    EnvironmentLight light;
    if (state.light) {
        light = prefilter(state.light->cube(optimized_light_size).to(scene.device));
        options.light = &light;
    }
    GuidanceInput input{render_view(scene, settings, state.field, seen, options).images,
                        seen.shape};
    if (state.guidance->needs_reference()) {
        const at::NoGradGuard no_grad;
        if (state.light) options.light = &state.first_light;
        input.reference = render_view(scene, settings, state.fitted, seen, options).images;
    }
    return input;
}

void run_iteration(const EditScene& scene, const EditSettings& settings, const Evenness& evenness,
                   EditState& state, IterationTimes& times) {
    const double start = seconds_now();
    const GuidanceInput input = look(scene, settings, state);
    const double rendered = seconds_now();
    const GuidanceOutput guidance = state.guidance->step(input, state.iteration);
    const double guided = seconds_now();

    // A single bad prediction (an overflow in bf16) must not destroy the field.
    const at::Tensor gradient = at::nan_to_num(guidance.latents_gradient, 0.0, 0.0, 0.0);
    guidance.latents.backward(gradient / settings.batch);
    evenness.backward(state);
    if (state.light) state.light->regularization().backward();
    const double back = seconds_now();

    const float factor = learning_rate_factor(settings, state);
    for (std::size_t group = 0; group < state.optimizer.group_count(); ++group) {
        const bool is_light = state.light && group + 1 == state.optimizer.group_count();
        state.optimizer.options(group).learning_rate =
            factor * (is_light ? settings.light_learning_rate : settings.learning_rate);
    }
    state.optimizer.step();
    state.optimizer.zero_grad();

    state.direction_length.push_back(guidance.direction_length);
    state.source_loss.push_back(guidance.source_loss);
    ++state.iteration;

    ++times.iterations;
    times.render += rendered - start;
    times.encode += guidance.seconds_encode;
    times.unet += guidance.seconds_unet;
    times.backward += back - guided;
    times.step += seconds_now() - back;
}

}  // namespace

EnvironmentLight light_as_it_is(const EditScene& scene, const EditState& state) {
    if (!state.light) return scene.lights->front();
    const at::NoGradGuard no_grad;
    return prefilter(state.light->cube(optimized_light_size).to(scene.device));
}

std::int64_t total_iterations(const EditSettings& settings) {
    return settings.iterations + (wants_detail(settings) ? settings.detail_views : 0);
}

IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state) {
    const EditSettings& settings = request.settings;
    IterationTimes times;
    const DirectionAdjustment adjustment(request, scene);
    const Evenness evenness(scene, settings, state);
    const auto adjust = [&](const auto& step) {
        const double start = seconds_now();
        try {
            step();
        } catch (const Interrupted&) {  // while a caption was written
            interrupt(request, state);
        }
        times.adjust += seconds_now() - start;
    };
    if (state.iteration < settings.iterations) {
        Progress progress("edit", settings.iterations, state.iteration);
        Safekeeping safekeeping(request, scene);
        while (state.iteration < settings.iterations) {
            adjust([&] { adjustment.before_iteration(state); });
            run_iteration(scene, settings, evenness, state, times);
            end_where_settled(settings, state);
            progress.update(state.iteration,
                            fmt::format("direction {:.3f}", state.direction_length.back()));
            safekeeping.after_step(state, progress);
        }
    }
    adjust([&] { adjustment.finish(state); });
    save_state(request, state);
    return times;
}

}  // namespace item3d
