#include "item3d/edit/optimize/color_regularizer.h"

#include "item3d/core/random.h"
#include "item3d/field/surface_points.h"
#include "item3d/processes/shared_rows.h"
#include "item3d/tensors/tensor.h"

namespace item3d {
namespace {

constexpr std::int64_t points = 2048;  ///< points in an iteration
constexpr std::int64_t draws = 16;     ///< iteration i uses the draw i modulo `draws`
/// Scale of residuals, in encoded values, which are roughly perceptually uniform. The residuals of
/// blotches are smaller, and those of distinct parts are larger.
constexpr float blotch = 0.25f;
constexpr int refits = 3;
constexpr std::int64_t roughness_output = 4;  ///< column of NeuralTexture::encoded()
constexpr std::int64_t metallic_output = 5;
/// Ridge term of the regression of the colour's change on the original colour. It pulls the
/// regression's slopes to 0 if the original colour is nearly uniform. The term is small beside the
/// variance of a spotted surface's colour, which is 0.1 or more.
constexpr float min_variance = 0.01f;
constexpr double max_draws = 32;  ///< largest oversampling factor, for a small region

/// Returns draws * points edited surface points, in the field's space.
at::Tensor edited_positions(const EditScene& scene, Random& random) {
    const SurfaceSampler sampler(scene.geometry, *scene.space);
    if (!scene.region) return scene.space->positions(sampler.sample(draws * points, random));
    const double wanted = draws * points / std::max(scene.region->share(), 1 / max_draws);
    const Surface surface = sampler.sample(static_cast<std::int64_t>(wanted), random);
    const at::Tensor inside = scene.region->weight(surface).squeeze(1).gt(0.5).nonzero().squeeze(1);
    const at::Tensor positions = scene.space->positions(surface);
    if (inside.size(0) == 0) return positions.narrow(0, 0, draws * points);
    // Takes a uniform subset of the points, in the sampler's order.
    const at::Tensor chosen =
        at::linspace(0, static_cast<double>(inside.size(0) - 1), draws * points, at::kDouble)
            .round()
            .to(inside.device(), at::kLong);
    return positions.index_select(0, inside.index_select(0, chosen));
}

}  // namespace

Departures departures(const at::Tensor& change, const at::Tensor& color, float scale) {
    const std::int64_t count = change.size(0);
    const at::Tensor features =
        at::cat({at::ones_like(color.narrow(1, 0, 1)), color - color.mean(0)}, 1);
    const at::Tensor ridge = min_variance * static_cast<float>(count) *
                             at::diag(at::tensor({0.0f, 1.0f, 1.0f, 1.0f}, color.options()));
    Departures found{change, at::ones({count, 1}, change.options())};
    for (int i = 0; i < refits; ++i) {
        const at::Tensor weighted = (features * found.weights).t();
        const at::Tensor slopes =
            at::linalg_solve(weighted.mm(features) + ridge, weighted.mm(change));
        found.values = change - features.mm(slopes);
        const at::Tensor squared = found.values.square().sum(1, true);
        found.weights = (1 + squared / (scale * scale)).square().reciprocal();
    }
    return found;
}

ColorRegularizer::ColorRegularizer(const EditScene& scene, const EditPlan& plan,
                                   const EditState& state) {
    if (!plan.regularizes_color) return;
    const at::NoGradGuard no_grad;
    weight_ = plan.evenness;
    Random random(plan.seed, RandomStream::color_points);
    const at::Tensor positions = edited_positions(scene, random);
    // The sampler orders the points along the surface. Each draw takes every draws-th point, and so
    // covers the whole surface.
    const auto deal = [](const at::Tensor& rows) {
        return rows.reshape({points, draws, -1}).transpose(0, 1).contiguous();
    };
    positions_ = deal(positions);
    fitted_ = deal(NeuralTexture(state.fitted)->encoded(positions));
    const float base_color = scene.start.channels.base_color ? 1 : 0;
    channels_ = at::tensor({base_color, base_color, base_color, 0.0f,
                            scene.start.channels.roughness ? 1.0f : 0.0f,
                            scene.start.channels.metallic ? 1.0f : 0.0f, 0.0f, 0.0f})
                    .to(scene.device);
    metal_roughness_ = scene.start.roughness;
    holds_metallic_ = scene.start.channels.metallic;
}

void ColorRegularizer::backward(const ProcessGroup& processes, EditState& state) const {
    if (weight_ == 0) return;
    const std::int64_t draw = state.iteration % draws;
    const Share share = processes.share(points);
    const at::Tensor own =
        state.field->encoded(positions_[draw].narrow(0, share.first, share.count));
    at::Tensor gradient;
    {
        const at::NoGradGuard no_grad;
        const at::Tensor before = fitted_[draw];
        const at::Tensor now = gather_rows(processes, own.detach(), share.first, points);
        const Departures found =
            departures((now - before) * channels_, before.narrow(1, 0, 3), blotch);
        gradient = found.values * found.weights * (weight_ / points);
        const auto hold = [&](std::int64_t output, float value) {
            gradient.select(1, output).copy_((now.select(1, output) - value) * (weight_ / points));
        };
        if (metal_roughness_) {
            hold(roughness_output, *metal_roughness_);
            if (holds_metallic_) hold(metallic_output, 1);
        }
    }
    own.backward(gradient.narrow(0, share.first, share.count));
}

}  // namespace item3d
