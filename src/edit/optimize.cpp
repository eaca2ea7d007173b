#include "item3d/edit/optimize.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/checkpoint_state.h"
#include "item3d/edit/preview.h"
#include "item3d/guidance/noised_latents.h"

#include <chrono>
#include <cmath>

namespace item3d {
namespace {

constexpr double seconds_between_checkpoints = 12;
constexpr double seconds_between_previews = 5;
constexpr int warm_up_iterations = 10;
constexpr float final_learning_rate = 0.1f;  ///< as a part of the first

/// Small pictures are drawn at twice their size and averaged, as the embedded prior's training
/// pictures were; large ones get their edges from antialias().
int supersampling(int resolution) {
    return resolution <= 128 ? 2 : 1;
}

struct View {
    torch::Tensor images;  ///< [N, 3, R, R] sRGB
    torch::Tensor depth;   ///< [N, R', R'] z-depth, 0: background
};

View render_view(const EditScene& scene, const EditSettings& settings, NeuralTexture& field,
                 std::int64_t iteration) {
    const int scale = supersampling(settings.resolution);
    const int size = settings.resolution * scale;
    const auto cameras = sample_cameras(scene.sphere, settings.batch, settings.seed, iteration);
    const EnvironmentLight& light = scene.lights->pick(settings.seed, iteration);

    const Raster raster = rasterize(scene.geometry, cameras, size, size);
    const Surface surface = interpolate_surface(scene.geometry, raster, cameras);
    const MaterialSample material = scene.source->sample(surface, field);
    torch::Tensor radiance = shade(surface, material, light);
    if (material.emissive.defined()) radiance = radiance + material.emissive;

    const torch::Tensor background =
        sample_backgrounds(settings.background, settings.batch, settings.seed, iteration)
            .view({settings.batch, 1, 1, 3})
            .expand({settings.batch, size, size, 3});
    torch::Tensor picture = scatter(radiance, surface, raster, background);
    if (scale == 1) picture = antialias(picture, raster, scene.geometry);
    picture = linear_to_srgb(picture.clamp(0, 1)).permute({0, 3, 1, 2});
    if (scale > 1) picture = torch::avg_pool2d(picture, scale);
    return {picture, raster.depth};
}

/// Warm-up, then a cosine down to a tenth: a function of the iteration alone, so that a resumed run
/// follows the same path.
float learning_rate_factor(std::int64_t iteration, std::int64_t iterations) {
    const float warm_up =
        std::min(1.0f, static_cast<float>(iteration + 1) / static_cast<float>(warm_up_iterations));
    const float progress = static_cast<float>(iteration) / static_cast<float>(iterations);
    const float cosine = 0.5f + 0.5f * std::cos(pi * progress);
    return warm_up * (final_learning_rate + (1 - final_learning_rate) * cosine);
}

void run_iteration(const EditScene& scene, const EditSettings& settings, EditState& state,
                   IterationTimes& times) {
    const double start = seconds_now();
    const View view = render_view(scene, settings, state.field, state.iteration);
    const double rendered = seconds_now();
    const GuidanceOutput guidance =
        state.guidance->step({view.images, view.depth}, state.iteration);
    const double guided = seconds_now();

    // A single bad prediction (an overflow in bf16) must not destroy the field.
    const torch::Tensor gradient = torch::nan_to_num(guidance.latents_gradient, 0.0, 0.0, 0.0);
    guidance.latents.backward(gradient / settings.batch);
    const double back = seconds_now();

    const float factor = learning_rate_factor(state.iteration, settings.iterations);
    for (std::size_t group = 0; group < state.optimizer.group_count(); ++group) {
        state.optimizer.options(group).learning_rate = settings.learning_rate * factor;
    }
    state.optimizer.step();
    state.optimizer.zero_grad();

    state.direction_length.push_back(guidance.direction_length);
    state.adjustment_loss.push_back(guidance.adjustment_loss);
    ++state.iteration;

    ++times.iterations;
    times.render += rendered - start;
    times.encode += guidance.seconds_encode;
    times.unet += guidance.seconds_unet;
    times.backward += back - guided;
    times.step += seconds_now() - back;
}

}  // namespace

IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state) {
    const EditSettings& settings = request.settings;
    IterationTimes times;
    Progress progress("edit", settings.iterations, state.iteration);
    Preview preview(request.output / "preview.png", scene);
    double checkpointed = seconds_now();
    double previewed = checkpointed;

    while (state.iteration < settings.iterations) {
        run_iteration(scene, settings, state, times);
        progress.update(state.iteration,
                        fmt::format("direction {:.3f}", state.direction_length.back()));

        const bool stop = interrupted() || state.iteration == request.stop_after;
        if (stop && state.iteration < settings.iterations) {
            save_state(request, state);
            progress.finish();
            throw Interrupted(fmt::format("iteration {} of {} is kept; go on with: {} --resume",
                                          state.iteration, settings.iterations, request.command));
        }
        const double now = seconds_now();
        if (now - checkpointed > seconds_between_checkpoints) {
            save_state(request, state);
            checkpointed = seconds_now();
        }
        if (now - previewed > seconds_between_previews) {
            preview.update(state.field);
            previewed = seconds_now();
        }
    }
    save_state(request, state);
    return times;
}

}  // namespace item3d
