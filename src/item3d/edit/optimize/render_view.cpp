#include "item3d/edit/optimize/render_view.h"

#include "item3d/core/random.h"
#include "item3d/edit/optimize/point_share.h"
#include "item3d/processes/shared_rows.h"
#include "item3d/region/seen_shape.h"
#include "item3d/render/antialias.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"

#include <ATen/CPUGeneratorImpl.h>

namespace item3d {
namespace {

constexpr int optimized_light_size = 32;  ///< edge of an optimised light's cube, texels
constexpr float background_gray = 0.75f;  ///< linear

at::Tensor offsets(const at::Tensor& positions, const EditScene& scene, const EditPlan& plan,
                   const ViewOptions& options) {
    Random random(plan.seed, RandomStream::spread, options.spread_draw);
    auto generator = at::detail::createCPUGenerator(random.bits());
    const float pixel = 2 * scene.sphere.radius / static_cast<float>(plan.resolution);
    const at::Tensor directions = at::randn(positions.sizes(), generator, at::kFloat);
    return options.spread * pixel * directions.to(positions.device());
}

/// Removes emission, which does not depend on the light's brightness.
MaterialSample without_emission(MaterialSample material) {
    material.emissive = at::Tensor();
    return material;
}

}  // namespace

ViewShare share_views(const ProcessGroup& processes, int total) {
    if (total >= processes.size()) return {total, processes.share(total), false};
    const std::int64_t first = std::min(processes.rank(), total);
    return {total, {first, processes.rank() < total ? 1 : 0}, true};
}

GBuffer rasterize_views(const EditScene& scene, const EditPlan& plan,
                        const std::vector<Camera>& cameras) {
    const int size = plan.resolution * plan.supersampling;
    GBuffer gbuffer;
    gbuffer.raster = rasterize(scene.geometry, cameras, size, size);
    gbuffer.surface = interpolate_surface(scene.geometry, gbuffer.raster, cameras);
    gbuffer.shape = seen_shape(gbuffer.raster, gbuffer.surface, scene.sphere);
    gbuffer.own = scene.source->own(gbuffer.surface);
    return gbuffer;
}

EditView render_view(const EditScene& scene, const EditPlan& plan, NeuralTexture& field,
                     const GBuffer& gbuffer, const ViewOptions& options) {
    const auto& [raster, surface, shape, own] = gbuffer;
    const ViewLight light = options.light ? ViewLight{*options.light}
                                          : scene.lights->pick(plan.seed, options.iteration);
    EditView view;
    view.points = options.processes.share(surface.count());
    const auto [first, count] = view.points;
    const Surface shaded = narrow(surface, view.points);
    view.surface = shaded;
    if (options.spread > 0)
        view.surface.position =
            shaded.position +
            offsets(surface.position, scene, plan, options).narrow(0, first, count);
    view.material = scene.source->sample(view.surface, field, narrow(own, view.points));
    at::Tensor radiance =
        light.exposure * shade(shaded, without_emission(view.material), light.light);
    if (view.material.emissive.defined()) radiance = radiance + view.material.emissive;
    radiance = gather_rows(options.processes, radiance, first, surface.count());

    const int views = raster.views(), size = raster.width();
    const int total = options.total_views > 0 ? options.total_views : views;
    const at::Tensor background =
        sample_backgrounds(plan.background, total, plan.seed, options.iteration)
            .narrow(0, options.first_view, views)
            .to(scene.device)
            .view({views, 1, 1, 3})
            .expand({views, size, size, 3});
    at::Tensor image = scatter(radiance, surface, raster, background);
    const int scale = plan.supersampling;
    if (scale == 1) image = antialias(image, raster, scene.geometry);
    view.images = linear_to_srgb(image.clamp(0, 1)).permute({0, 3, 1, 2});
    view.coverage = (raster.triangle >= 0).to(at::kFloat).unsqueeze(1);
    if (scale > 1) {
        view.images = at::avg_pool2d(view.images, scale);
        view.coverage = at::avg_pool2d(view.coverage, scale);
    }
    return view;
}

EnvironmentLight prefilter_light(const EditScene& scene, const LightModel& light) {
    return prefilter(light.cube(optimized_light_size).to(scene.device));
}

EnvironmentLight current_light(const EditScene& scene, const EditState& state) {
    if (!state.light) return scene.lights->front();
    const at::NoGradGuard no_grad;
    return prefilter_light(scene, *state.light);
}

std::vector<Camera> field_cameras(const EditScene& scene, int count) {
    return turntable(scene.model.bounds(), count, 0.35f, 0.6f);
}

at::Tensor draw_field(const EditScene& scene, NeuralTexture& field, const EnvironmentLight& light,
                      const std::vector<Camera>& cameras, int size) {
    const at::NoGradGuard no_grad;
    const Raster raster = rasterize(scene.geometry, cameras, size, size);
    const Surface surface = interpolate_surface(scene.geometry, raster, cameras);
    const MaterialSample material =
        scene.source->sample(surface, field, scene.source->own(surface));
    const at::Tensor background = at::full({3}, background_gray, scene.device);
    const at::Tensor images = scatter(shade(surface, material, light), surface, raster, background);
    return linear_to_srgb(antialias(images, raster, scene.geometry).clamp(0, 1));
}

}  // namespace item3d
