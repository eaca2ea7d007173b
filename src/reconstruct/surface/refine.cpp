#include "item3d/reconstruct/surface/refine.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/reconstruct/view_order.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace item3d {

namespace {

constexpr double final_rate = 0.1;
constexpr std::int64_t smoothness_points = 4096;
constexpr float farthest_smoothness = 0.15f;  ///< of the object's diagonal

/// World units of a pixel of the first view at the middle of the bounds.
float pixel_size(std::array<Vec3, 2> bounds, const TargetView& view) {
    const float distance = glm::distance(view.camera.position(), 0.5f * (bounds[0] + bounds[1]));
    return 2 * std::tan(0.5f * view.camera.field_of_view_x) * distance /
           static_cast<float>(view.width());
}

double falling(double rate, int iteration, int iterations) {
    const double progress = static_cast<double>(iteration) / iterations;
    return rate * (final_rate + (1 - final_rate) * 0.5 * (1 + std::cos(pi * progress)));
}

/// light: none: from everywhere.
Occlusion trace_occlusion(const MovableMesh& mesh, const TrainableLight* light) {
    const torch::NoGradGuard no_gradient;
    OcclusionOptions options;
    options.rays = 128;
    if (light != nullptr) options.light = light->to_image();
    return Occlusion(mesh.geometry(), nullptr, options);
}

}  // namespace

MaterialRanges reconstruction_ranges() {
    MaterialRanges ranges;
    ranges.base_color = {0.03f, 1.0f};
    ranges.roughness = {0.08f, 1.0f};
    ranges.normal_slope = 1.0f;
    return ranges;
}

Appearance make_appearance(std::array<Vec3, 2> bounds, const std::vector<TargetView>& views,
                           std::uint64_t seed) {
    NeuralTextureOptions options;
    options.seed = seed;
    options.ranges = reconstruction_ranges();
    const Vec3 size = bounds[1] - bounds[0];
    const float extent = std::max({size.x, size.y, size.z});
    options.bounds = {bounds[0] - 0.02f * extent, bounds[1] + 0.02f * extent};
    options.finest_resolution =
        std::clamp(static_cast<int>(extent / pixel_size(bounds, views.front())), 64, 1024);
    NeuralTexture field(options);
    {
        // Most things are no metal, and a grey metal explains a picture nearly as well as paint.
        const torch::NoGradGuard no_gradient;
        field->metallic_bias().fill_(-3.0f);
    }
    return {std::move(field), TrainableLight()};
}

RefineCurves refine(Appearance& appearance, MovableMesh& mesh, const Model& model,
                    const std::vector<TargetView>& views, const RefineOptions& options) {
    Adam adam;
    adam.add_group({appearance.field->table()}, {.learning_rate = options.field_learning_rate});
    adam.add_group(appearance.field->network_parameters(),
                   {.learning_rate = 0.5 * options.field_learning_rate});
    adam.add_group(appearance.light.parameters(),
                   {.learning_rate = options.light_learning_rate, .beta2 = 0.999});
    if (mesh.moves()) {
        adam.add_group(
            {mesh.offsets()},
            {.learning_rate = options.vertex_learning_rate * mesh.mean_edge(), .beta2 = 0.999});
    }
    std::vector<double> rates;
    for (std::size_t group = 0; group < adam.group_count(); ++group)
        rates.push_back(adam.options(group).learning_rate);

    std::optional<Occlusion> occlusion;
    const int trace_every = std::max(1, (options.iterations + 3) / 4);
    const auto bounds = model.bounds();
    const float pixel = pixel_size(bounds, views.front());
    const float farthest = farthest_smoothness * glm::length(bounds[1] - bounds[0]);
    const RegularizerWeights& weights = options.weights;
    ViewOrder order(views.size(), options.seed);
    Random random(options.seed, 0x726566696e65);
    RefineCurves curves;
    Progress progress("materials and light", options.iterations);
    EnvironmentLight light;
    for (int i = 0; i < options.iterations; ++i) {
        if (options.shadows && i % trace_every == 0)
            occlusion = trace_occlusion(mesh, i > 0 ? &appearance.light : nullptr);
        // A prefiltered light costs as much as a view: its gradients are used once in a while.
        const bool light_learns = i % options.light_every == 0;
        if (light_learns) {
            light = appearance.light.prefiltered();
        } else if (i % options.light_every == 1) {
            const torch::NoGradGuard no_gradient;
            light = appearance.light.prefiltered();
        }
        const TargetView& view = views[order.at(i)];
        Geometry geometry = mesh.geometry();
        // One material would dent what is printed on it, so the shape stands still meanwhile.
        const bool light_alone = i < options.light_alone * options.iterations;
        if (light_alone) {
            geometry.positions = geometry.positions.detach();
            geometry.normals = geometry.normals.detach();
        }
        const RenderedView rendered = render_view(geometry, appearance.field, light, view,
                                                  {.occlusion = occlusion ? &*occlusion : nullptr,
                                                   .normal_map = options.normal_map && !light_alone,
                                                   .one_material = light_alone});
        const torch::Tensor background = torch::full({3}, static_cast<float>(random.uniform()));
        const torch::Tensor picture = picture_loss(rendered.image, view.image, background);
        const torch::Tensor mask = mask_loss(rendered.image, view.image);
        torch::Tensor loss = picture;
        if (rendered.surface.count() > 0) {
            loss = loss +
                   weights.smoothness * smoothness_loss(appearance.field, rendered, pixel, farthest,
                                                        smoothness_points, random) +
                   weights.brightness * brightness_loss(rendered);
            if (options.normal_map)
                loss = loss +
                       weights.flat_normals * (1 - rendered.material.normal.select(1, 2)).mean();
        }
        if (light_learns) loss = loss + weights.whiteness * appearance.light.whiteness_loss();
        if (mesh.moves()) loss = loss + weights.mask * mask + weights.crumpling * mesh.crumpling();
        loss.backward();
        for (std::size_t group = 0; group < rates.size(); ++group)
            adam.options(group).learning_rate = falling(rates[group], i, options.iterations);
        adam.step();
        adam.zero_grad();

        curves.picture.push_back(picture.item<double>());
        curves.mask.push_back(mask.item<double>());
        progress.update(i + 1, fmt::format("difference {:.4f}", curves.picture.back()));
        if (interrupted())
            throw Interrupted("interrupted while materials and light were looked for");
    }
    return curves;
}

}  // namespace item3d
