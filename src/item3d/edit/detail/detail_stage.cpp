#include "item3d/edit/detail/detail_stage.h"

#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/edit/detail/painting_plan.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/checkpoint_writer.h"
#include "item3d/edit/optimize/point_share.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/networks/diffusion/generate.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/processes/gradients.h"

#include <algorithm>
#include <map>
#include <vector>

namespace item3d {
namespace {

constexpr int sampling_steps = 24;
/// Noise strength of the initial round, from 0 to 1. It is nearly 1 if the prior takes the shape as
/// a condition.
constexpr double initial_strength = 0.95;
constexpr double initial_strength_without_shape = 0.7;
constexpr double refine_strength = 0.7;
constexpr double close_up_strength = 0.5;
constexpr float painting_guidance_scale = 5.0f;
/// Weight of the high frequencies added to a decoded image, since a small autoencoder's decoder
/// blurs.
constexpr float sharpening = 0.3f;
/// Ratio of the image edge to the width of the two box filters that separate detail.
constexpr int filter_share = 8;
constexpr float known_weight = 0.3f;  ///< weight of the pixels of earlier views in a view's fit
constexpr int fits = 24;              ///< optimiser steps for each view
constexpr int last_fits = 200;        ///< optimiser steps for all images at the end
constexpr double table_rate = 0.01, network_rate = 0.0025;  ///< initial learning rates
/// Final learning rate relative to the initial one. The rate falls so that the images fitted last
/// have no greater weight than the others.
constexpr double final_rate = 0.05;
constexpr float spread = 0.5f;  ///< ViewOptions::spread, pixels
/// Largest image edge, in pixels, at which the G-buffers of views are cached. Each then takes about
/// 2 MB.
constexpr int largest_kept = 128;

at::Tensor blur(at::Tensor images) {
    const auto size = images.size(2) / filter_share | 1;
    for (int i = 0; i < 2; ++i) {
        images = at::avg_pool2d(images, {size, size}, {1, 1}, {size / 2, size / 2}, false,
                                /*count_include_pad=*/false);
    }
    return images;
}

/// Returns the images minus their low frequencies over the covered part; ignores the background.
at::Tensor fine_part(const at::Tensor& images, const at::Tensor& coverage) {
    return images - blur(images * coverage) / (blur(coverage) + 1e-4f);
}

/// Returns the covered pixels whose neighbours are covered too. This excludes silhouettes, where
/// the prior draws an outline.
at::Tensor inner(const at::Tensor& coverage) {
    return -at::max_pool2d(-coverage, 3, 1, 1);
}

/// A view of the plan, with the materials from before the stage.
struct PaintedView {
    GBuffer gbuffer;
    MaterialSample before;  ///< the field's materials before the stage
};

/// Returns the mean squared change of the channels that the stage must keep. They can change
/// because all channels share the field's features. The sample points of `now` and `before` differ
/// by up to half a pixel, over which these channels vary little. points: number of all points of
/// the view, of which `now` has a share.
at::Tensor drift(const MaterialSample& now, const MaterialSample& before, std::int64_t points) {
    const auto values = static_cast<double>(3 * points);
    at::Tensor moved = (now.orm - before.orm).square().sum() / values;
    if (before.normal.defined())
        moved = moved + (now.normal - before.normal).square().sum() / values;
    return moved;
}

/// A running detail stage.
class Painter {
  public:
    Painter(const EditRequest& request, const EditScene& scene, EditState& state)
        : processes_(request.processes),
          scene_(scene),
          plan_(request.plan),
          state_(state),
          views_(plan_painting(scene, plan_)) {
        set_learning_rates(1);
    }

    void paint(std::size_t index);

  private:
    PaintedView see(std::size_t index);
    EditView render(std::size_t index, const GBuffer& gbuffer, float spread_pixels = 0,
                    std::uint64_t draw = 0) const;
    at::Tensor known_pixels(std::size_t index) const;
    double strength(const PaintingView& planned) const;
    at::Tensor target(std::size_t index, const GBuffer& gbuffer) const;
    void fit_step(std::size_t chosen, std::uint64_t draw);
    void set_learning_rates(double factor);
    void fit_all();

    const ProcessGroup& processes_;
    const EditScene& scene_;
    const EditPlan& plan_;
    EditState& state_;
    std::vector<PaintingView> views_;
    std::map<std::size_t, PaintedView> kept_;  ///< cached small views by index in the plan
};

/// Returns a view, from the cache if possible, because each view is used dozens of times.
PaintedView Painter::see(std::size_t index) {
    const auto found = kept_.find(index);
    if (found != kept_.end()) return found->second;
    const at::NoGradGuard no_grad;
    PaintedView view{rasterize_views(scene_, plan_, {views_[index].camera}), {}};
    const auto& [raster, surface, shape, own] = view.gbuffer;
    view.before = scene_.source->sample(surface, state_.detail.before, own);
    if (plan_.resolution <= largest_kept) kept_[index] = view;
    return view;
}

EditView Painter::render(std::size_t index, const GBuffer& gbuffer, float spread_pixels,
                         std::uint64_t draw) const {
    ViewOptions options{plan_.iterations + static_cast<std::int64_t>(index)};
    options.light = &scene_.lights->studio();
    options.spread = spread_pixels;
    options.spread_draw = draw;
    options.processes = processes_;
    return render_view(scene_, plan_, state_.field, gbuffer, options);
}

/// Returns weights [1, 1, R, R], 0 to 1, of pixels that earlier views painted.
at::Tensor Painter::known_pixels(std::size_t index) const {
    return at::upsample_bilinear2d(views_[index].known, views_[index].facing.sizes().slice(2),
                                   /*align_corners=*/false);
}

double Painter::strength(const PaintingView& planned) const {
    switch (planned.round) {
        case PaintingRound::refine:
            return refine_strength;
        case PaintingRound::close_up:
            return close_up_strength;
        case PaintingRound::initial:
            break;
    }
    return takes_shape(*scene_.prior()) ? initial_strength : initial_strength_without_shape;
}

/// Returns the prior's sample for this view, [1, 3, R, R].
at::Tensor Painter::target(std::size_t index, const GBuffer& gbuffer) const {
    const at::NoGradGuard no_grad;
    const EditView view = render(index, gbuffer);
    const DiffusionModel& prior = *scene_.prior();
    const PaintingView& planned = views_[index];
    const at::Tensor latents = prior.encode_image(view.images * 2 - 1);
    GenerateOptions options;
    options.prompt = scene_.to;
    options.negative_prompt = plan_.negative_prompt;
    options.steps = sampling_steps;
    options.guidance_scale = painting_guidance_scale;
    options.image = latents;
    options.keep = planned.known;
    options.strength = strength(planned);
    options.scheduler = "ddim";
    options.eta = 1;
    options.seed = mix_bits(plan_.seed) + index;
    options.show_progress = false;
    options.processes = processes_;
    const at::Tensor condition = condition_of_shape(prior, gbuffer.shape, latents);
    const at::Tensor sampled = generate_latents(prior, options, condition);
    const at::Tensor decoded = prior.decode_image(sampled) / 2 + 0.5f;
    // The fine part comes from the decoded image and not from the render. A close-up's render
    // contains noise finer than the pixels of the previous round, which did not constrain it.
    const at::Tensor fresh = 1 - known_pixels(index);
    const at::Tensor painted = view.images + fresh * (decoded - view.images);
    return (painted + sharpening * fresh * fine_part(decoded, view.coverage)).clamp(0, 1);
}

void Painter::fit_step(std::size_t chosen, std::uint64_t draw) {
    const auto& [gbuffer, before] = see(chosen);
    const EditView view = render(chosen, gbuffer, spread, draw);
    const at::Tensor weight = inner(view.coverage) * views_[chosen].facing *
                              (1 - (1 - known_weight) * known_pixels(chosen));
    const at::Tensor apart =
        ((view.images - state_.detail.targets[chosen]).square() * weight).sum() /
        (weight.sum() + 1e-4f);
    const at::Tensor moved =
        drift(view.material, narrow(before, view.points), gbuffer.surface.count());
    // Every process has the whole image, so only the first process adds the image's loss.
    (processes_.first() ? apart + moved : 0 * apart + moved).backward();
    sum_gradients(processes_, state_.detail.optimizer.parameters());
    state_.detail.optimizer.step();
    state_.detail.optimizer.zero_grad();
}

void Painter::paint(std::size_t index) {
    state_.detail.targets.push_back(target(index, see(index).gbuffer));
    for (std::size_t i = 0; i < fits; ++i) {
        const std::uint64_t draw = index * fits + i;
        Random random(plan_.seed, RandomStream::painting, draw);
        // Every second step fits a random view of this round up to this one, so that views do not
        // undo each other. Views of earlier rounds are excluded, because this round refines their
        // images.
        const auto first = static_cast<std::size_t>(views_[index].first_of_round);
        const auto back = random.index(static_cast<std::int64_t>(index - first) + 1);
        fit_step(i % 2 == 0 ? index : index - static_cast<std::size_t>(back), draw);
    }
    if (index + 1 == views_.size()) fit_all();
    ++state_.iteration;
}

void Painter::set_learning_rates(double factor) {
    state_.detail.optimizer.options("table").learning_rate = factor * table_rate;
    state_.detail.optimizer.options("network").learning_rate = factor * network_rate;
}

/// Fits all images once more, except those of the initial round, because later views may have
/// damaged what earlier views painted.
void Painter::fit_all() {
    const auto first = std::find_if(views_.begin(), views_.end(), [](const PaintingView& view) {
        return view.round != PaintingRound::initial;
    });
    const std::int64_t skipped = first - views_.begin();
    const std::int64_t count = views_.end() - first;
    if (count == 0) return;
    for (std::size_t i = 0; i < last_fits; ++i) {
        const double left = 1 - static_cast<double>(i) / last_fits;
        set_learning_rates(final_rate + (1 - final_rate) * left);
        const std::uint64_t draw = views_.size() * fits + i;
        Random random(plan_.seed, RandomStream::painting, draw);
        fit_step(static_cast<std::size_t>(skipped + random.index(count)), draw);
    }
}

}  // namespace

void add_detail(const EditRequest& request, const EditScene& scene, EditState& state) {
    const EditPlan& plan = request.plan;
    const std::int64_t total = plan.total_iterations;
    if (state.iteration >= total) return;
    if (!state.detail.has_begun()) state.detail.begin(state.field);
    Progress progress("detail", plan.detail_views, state.iteration - plan.iterations);
    CheckpointWriter checkpoints(request, scene, state.fitted);
    Painter painter(request, scene, state);
    while (state.iteration < total) {
        painter.paint(state.detail.targets.size());
        progress.update(state.iteration - plan.iterations);
        checkpoints.after_step(state, progress);
    }
    save_state(request, state);
}

}  // namespace item3d
