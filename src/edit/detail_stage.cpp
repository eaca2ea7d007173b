#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/edit/checkpoint_state.h"
#include "item3d/edit/optimize.h"
#include "item3d/edit/render_view.h"
#include "item3d/edit/safekeeping.h"
#include "item3d/models/depth_condition.h"

#include <torch/nn/functional/pooling.h>

namespace item3d {
namespace {

constexpr int sampling_steps = 40;
constexpr double first_strength = 0.9;  ///< later views keep more of what earlier ones drew
constexpr double last_strength = 0.4;
constexpr float guidance_scale = 5.0f;
/// A small autoencoder flattens what it decodes; twice its difference is about what was there.
constexpr float contrast = 2.0f;
/// Detail is what two box filters of this part of the picture's edge take away.
constexpr int filter_share = 4;
constexpr int fits = 16;  ///< steps of the optimiser for each view
constexpr double learning_rate = 0.01;
constexpr double network_learning_rate = 0.0025;
constexpr float spread = 0.5f;              ///< pixels, see ViewOptions
constexpr std::uint64_t choice_stream = 7;  // of the edit's seed

torch::Tensor blur(torch::Tensor images) {
    const auto size = images.size(2) / filter_share | 1;
    for (int i = 0; i < 2; ++i) {
        images = torch::avg_pool2d(images, {size, size}, {1, 1}, {size / 2, size / 2}, false,
                                   /*count_include_pad=*/false);
    }
    return images;
}

/// Without what varies slowly over the covered part; the background does not count.
torch::Tensor fine_part(const torch::Tensor& images, const torch::Tensor& coverage) {
    return images - blur(images * coverage) / (blur(coverage) + 1e-4f);
}

/// Pixels whose neighbours are covered too: at silhouettes the prior draws its own outline.
torch::Tensor inner(const torch::Tensor& coverage) {
    return -torch::max_pool2d(-coverage, 3, 1, 1);
}

/// What the prior would rather see from here, with the coarse part of the picture as it is.
torch::Tensor wanted_picture(const EditScene& scene, const EditSettings& settings,
                             const EditView& view, int index) {
    const Pipeline& prior = *scene.prior();
    const torch::Tensor latents = prior.encode_image(view.images * 2 - 1);
    GenerateOptions options;
    options.prompt = settings.to;
    options.negative_prompt = settings.negative_prompt;
    options.steps = sampling_steps;
    options.guidance_scale = guidance_scale;
    options.image = latents;
    options.strength = first_strength + (last_strength - first_strength) * index /
                                            std::max(1, settings.detail_views - 1);
    options.scheduler = "ddim";
    options.eta = 1;
    options.seed = mix_bits(settings.seed) + static_cast<std::uint64_t>(index);
    options.show_progress = false;
    const torch::Tensor depth = condition_of_depth(prior, view.depth, latents);
    const torch::Tensor sampled = generate_latents(prior, options, depth);
    // The difference of two decoded pictures: what the autoencoder loses cancels out.
    const torch::Tensor change = (prior.decode_image(sampled) - prior.decode_image(latents)) / 2;
    return (view.images + contrast * fine_part(change, view.coverage)).clamp(0, 1);
}

/// How far the channels that the stage leaves alone have moved; the field's features are shared by
/// all of them.
torch::Tensor drift(const EditScene& scene, const EditView& view, NeuralTexture& before) {
    const MaterialSample was = [&] {
        const torch::NoGradGuard no_grad;
        return scene.source->sample(view.surface, before);
    }();
    torch::Tensor moved = (view.material.orm - was.orm).square().mean();
    if (was.normal.defined()) moved = moved + (view.material.normal - was.normal).square().mean();
    return moved;
}

void fit_step(const EditScene& scene, const EditSettings& settings, EditState& state,
              std::int64_t chosen, std::uint64_t draw) {
    const EditView view =
        render_view(scene, settings, state.field, {1, settings.iterations + chosen, spread, draw});
    const torch::Tensor weight = inner(view.coverage);
    const torch::Tensor target = state.detail.targets[static_cast<std::size_t>(chosen)];
    const torch::Tensor apart =
        ((view.images - target).square() * weight).sum() / (weight.sum() + 1e-4f);
    (apart + drift(scene, view, state.detail.before)).backward();
    state.detail.optimizer.step();
    state.detail.optimizer.zero_grad();
}

void run_view(const EditScene& scene, const EditSettings& settings, EditState& state) {
    const auto index = static_cast<int>(state.detail.targets.size());
    {
        const torch::NoGradGuard no_grad;
        const EditView view = render_view(scene, settings, state.field, {1, state.iteration});
        state.detail.targets.push_back(wanted_picture(scene, settings, view, index));
    }
    for (int i = 0; i < fits; ++i) {
        const auto draw = static_cast<std::uint64_t>(index * fits + i);
        Random random(settings.seed, choice_stream, draw);
        // Every other step looks back, so that one view does not undo another.
        fit_step(scene, settings, state, i % 2 == 0 ? index : random.index(index + 1), draw);
    }
    ++state.iteration;
}

}  // namespace

void begin_detail(EditState& state) {
    state.detail.before = snapshot(state.field);
    AdamOptions options;
    options.learning_rate = learning_rate;
    state.detail.optimizer.add_group({state.field->table()}, options);
    options.learning_rate = network_learning_rate;
    state.detail.optimizer.add_group(state.field->network_parameters(), options);
}

void add_detail(const EditRequest& request, const EditScene& scene, EditState& state) {
    const EditSettings& settings = request.settings;
    const std::int64_t total = total_iterations(settings);
    if (state.iteration >= total) return;
    if (state.detail.before.is_empty()) begin_detail(state);
    Progress progress("detail", settings.detail_views, state.iteration - settings.iterations);
    Safekeeping safekeeping(request, scene);
    while (state.iteration < total) {
        run_view(scene, settings, state);
        progress.update(state.iteration - settings.iterations);
        safekeeping.after_step(state, progress);
    }
    save_state(request, state);
}

}  // namespace item3d
