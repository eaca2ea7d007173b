#include "item3d/baselines/sync_mvd.h"

#include "item3d/baselines/leftovers.h"
#include "item3d/baselines/view_lists.h"
#include "item3d/networks/diffusion/samplers/sampler.h"
#include "item3d/render/scatter.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int sync_steps = 30;
constexpr double last_exponent = 6;
constexpr double together = 0.8;           ///< share of the steps after which the views separate
constexpr double shuffled = 0.4;           ///< share of the steps in which the background changes
constexpr float latent_tolerance = 0.03f;  ///< depth tolerance, in model radii

/// Smallest sum of bilinear weights of covered cells; below it a texel counts as background.
constexpr double min_covered = 0.25;

/// Returns the network output that, for the noisy latents `sample`, predicts the clean latents
/// `clean`. alpha: cumulative alpha of the noise level.
at::Tensor output_of(const NoiseSchedule& schedule, const at::Tensor& sample,
                     const at::Tensor& clean, double alpha) {
    if (schedule.config().prediction_type == "sample") return clean;
    const at::Tensor noise_in = (sample - std::sqrt(alpha) * clean) / std::sqrt(1 - alpha);
    return schedule.predicts_velocity() ? std::sqrt(alpha) * noise_in - std::sqrt(1 - alpha) * clean
                                        : noise_in;
}

}  // namespace

at::Tensor view_weight(const at::Tensor& cosine, int step, int steps) {
    const double exponent = steps > 1 ? last_exponent * step / (steps - 1) : last_exponent;
    return cosine.pow(exponent) * (cosine > 0);
}

MergedTexels merge_views(const std::vector<at::Tensor>& values,
                         const std::vector<at::Tensor>& weights) {
    at::Tensor sum = at::zeros_like(values.front());
    at::Tensor total = at::zeros_like(weights.front());
    for (std::size_t i = 0; i < values.size(); ++i) {
        sum = sum + values[i] * weights[i].unsqueeze(1);
        total = total + weights[i];
    }
    return {sum / total.clamp_min(1e-12).unsqueeze(1), total > 0};
}

SyncMvd::SyncMvd(const PaintingScene& scene, const PainterOptions& options)
    : ViewPainter(scene, options) {
    options_.steps = static_cast<int>(step_count(options));
    begin();
}

std::int64_t SyncMvd::step_count(const PainterOptions& options) {
    return options.steps > 0 ? options.steps : sync_steps;
}

void SyncMvd::begin() {
    const at::NoGradGuard no_grad;
    const DiffusionModel& prior = *scene_.prior;
    const int size = scene_.resolution / prior.downscale();
    std::vector<at::Tensor> conditions;
    for (const ViewAngles& angles : first_views(synchronized_views(), options_.views)) {
        LatentView each;
        each.view = side_view(scene_, angles);
        const Camera& camera = each.view.camera;
        each.raster = rasterize(scene_.geometry, {camera}, size, size);
        each.surface = interpolate_surface(scene_.geometry, each.raster, {camera});
        each.covered = (each.raster.triangle >= 0).to(at::kFloat).unsqueeze(1);
        const ViewRender render(scene_, each.view);
        each.texels = see_texels(scene_.latent_texels->surface(), camera, render.depth(),
                                 latent_tolerance * scene_.radius);
        const at::Tensor latents =
            at::empty({1, prior.latent_channels(), size, size}, scene_.source.options());
        const at::Tensor condition = render.condition(prior, latents);
        if (condition.defined()) conditions.push_back(condition);
        views_.push_back(std::move(each));
    }
    if (!conditions.empty()) conditions_ = at::cat(conditions);
    latent_texture_ =
        noise({scene_.latent_texels->count(), prior.latent_channels()}, BaselineDraw::views, 0);
}

at::Tensor SyncMvd::noise(at::IntArrayRef sizes, BaselineDraw draw, std::uint64_t index) const {
    return seeded_noise(sizes, options_.seed, draw, index).to(scene_.source.device());
}

/// Returns latents [1, C, h, w] of a background of one colour. The colour changes in each of the
/// first steps, so that it does not become part of the object.
at::Tensor SyncMvd::background(std::int64_t index) const {
    const auto last = static_cast<std::int64_t>(shuffled * options_.steps);
    Random random = seeded_random(options_.seed, BaselineDraw::backgrounds,
                                  static_cast<std::uint64_t>(std::min(index, last)));
    at::Tensor image = at::empty({1, 3, scene_.resolution, scene_.resolution});
    for (int c = 0; c < 3; ++c)
        image.select(1, c).fill_(random.uniform());
    return encode(image.to(scene_.source.device()));
}

/// Renders the latent texture in all views, over the background latents `behind` [N, C, h, w] of
/// the same noise level. Returns [N, C, h, w].
at::Tensor SyncMvd::texture_to_views(const at::Tensor& behind) const {
    std::vector<at::Tensor> latents;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const LatentView& each = views_[v];
        const at::Tensor seen =
            scene_.latent_texels->lookup(latent_texture_, each.surface, /*nearest=*/true);
        latents.push_back(
            scatter(
                seen, each.surface, each.raster,
                behind[static_cast<std::int64_t>(v)].permute({1, 2, 0}).unsqueeze(0).contiguous())
                .permute({0, 3, 1, 2}));
    }
    return at::cat(latents);
}

void SyncMvd::step(std::int64_t index) {
    const at::NoGradGuard no_grad;
    const DiffusionModel& prior = *scene_.prior;
    const NoiseSchedule schedule(prior.schedule().config().with_sampler("ddim"));
    const auto sampler = make_sampler(schedule, {options_.steps, 0, /*eta=*/1});
    const int i = static_cast<int>(index);
    const double alpha =
        schedule.alphas_cumprod()[static_cast<std::int64_t>(sampler->timestep(i))].item<double>();
    const auto number = static_cast<std::uint64_t>(index);
    const auto count = static_cast<std::int64_t>(views_.size());
    const std::int64_t size = scene_.resolution / prior.downscale();
    const std::vector<std::int64_t> sizes{count, prior.latent_channels(), size, size};
    const at::Tensor fresh = noise(sizes, BaselineDraw::view_steps, number);

    at::Tensor latents = view_latents_;
    if (!latents.defined())
        latents = texture_to_views(sampler->add_noise(i, background(index).expand(sizes), fresh));
    GuidedModel model(prior, scene_.prompt, scene_.negative_prompt, options_.cfg);
    model.condition = conditions_;
    if (scene_.says_sides) {
        model.text = {};
        for (const LatentView& each : views_) {
            const TextEmbedding row = prior.encode_text({prompt_of_side(scene_, each.view.side)});
            model.text = model.text.states.defined() ? TextEmbedding::join(model.text, row) : row;
        }
    }
    const at::Tensor output = model(latents, sampler->timestep(i));

    if (index < together * options_.steps) {
        const at::Tensor clean = schedule.interpret(output, latents, alpha).clean;
        std::vector<at::Tensor> values, weights;
        for (std::int64_t v = 0; v < count; ++v) {
            const LatentView& each = views_[static_cast<std::size_t>(v)];
            const ImageSample sample = sample_pixels(clean[v], each.covered[0], each.texels.place);
            values.push_back(sample.values);
            weights.push_back(view_weight(each.texels.cosine, i, options_.steps) *
                              (sample.share > min_covered));
        }
        const MergedTexels merged = merge_views(values, weights);
        const at::Tensor spread =
            fill_from_neighbours(*scene_.latent_texels, merged.values, merged.known);
        latent_texture_ =
            sampler->step(i, output_of(schedule, latent_texture_, spread, alpha), latent_texture_,
                          noise(latent_texture_.sizes(), BaselineDraw::texture_steps, number));
        // The views' own latents are not needed before the views separate.
        if (index + 1 >= together * options_.steps)
            view_latents_ = texture_to_views(sampler->step(i, output, latents, fresh));
    } else {
        view_latents_ = sampler->step(i, output, latents, fresh);
    }
    if (i + 1 == options_.steps) paint_views(view_latents_);
}

void SyncMvd::paint_views(const at::Tensor& latents) {
    std::vector<at::Tensor> values, weights;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const ViewRender render(scene_, views_[v].view);
        images_.push_back(decode(latents.narrow(0, static_cast<std::int64_t>(v), 1)));
        const ImageSample sample = render.colors_of(images_.back());
        values.push_back(sample.values);
        weights.push_back(view_weight(render.texels().cosine, options_.steps - 1, options_.steps) *
                          sample.share);
    }
    const MergedTexels merged = merge_views(values, weights);
    const at::Tensor here = merged.known & (scene_.weight.squeeze(1) > 0);
    colors_ = at::where(here.unsqueeze(1), merged.values, colors_);
    painted_ = here.to(painted_.scalar_type());
}

void SyncMvd::finish() {
    colors_ = at::where(scene_.weight > 0,
                        fill_from_neighbours(*scene_.texels, colors_, painted_ > 0), colors_);
}

NamedTensors SyncMvd::state() const {
    NamedTensors tensors = ViewPainter::state();
    tensors.emplace_back("latent_texture", latent_texture_);
    if (view_latents_.defined()) tensors.emplace_back("view_latents", view_latents_);
    return tensors;
}

void SyncMvd::load_state(const CheckpointReader& reader) {
    ViewPainter::load_state(reader);
    reader.copy("latent_texture", latent_texture_);
    if (reader.has("view_latents"))
        view_latents_ = reader.get("view_latents").to(latent_texture_.device());
}

}  // namespace item3d
