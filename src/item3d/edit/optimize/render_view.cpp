#include "item3d/edit/optimize/render_view.h"

#include "item3d/core/random.h"
#include "item3d/render/antialias.h"
#include "item3d/render/pictures.h"
#include "item3d/render/scatter.h"

#include <ATen/CPUGeneratorImpl.h>

namespace item3d {
namespace {

constexpr std::uint64_t spread_stream = 6;  // of the edit's seed; others are in views.cpp

/// Small pictures are drawn at twice their size and averaged, as the embedded prior's training
/// pictures were; large ones get their edges from antialias().
int supersampling(int resolution) {
    return resolution <= 128 ? 2 : 1;
}

at::Tensor offsets(const at::Tensor& positions, const EditScene& scene,
                   const EditSettings& settings, const ViewOptions& options) {
    Random random(settings.seed, spread_stream, options.spread_draw);
    auto generator = at::detail::createCPUGenerator(random.bits());
    const float pixel = 2 * scene.sphere.radius / static_cast<float>(settings.resolution);
    const at::Tensor directions = at::randn(positions.sizes(), generator, at::kFloat);
    return options.spread * pixel * directions.to(positions.device());
}

}  // namespace

SeenShape seen_shape(const Raster& raster, const Surface& surface, const BoundingSphere& sphere) {
    const at::NoGradGuard no_grad;
    const auto options = surface.position.options();
    const at::Tensor center =
        at::tensor({sphere.center.x, sphere.center.y, sphere.center.z}, options);
    const auto pixels = [&](const at::Tensor& values) {
        return scatter(values, surface, raster, at::zeros({3}, options));
    };
    return {raster.depth, pixels((surface.position - center) / sphere.radius),
            pixels(surface.normal)};
}

SeenModel see_model(const EditScene& scene, const EditSettings& settings,
                    const std::vector<Camera>& cameras) {
    const int size = settings.resolution * supersampling(settings.resolution);
    SeenModel seen;
    seen.raster = rasterize(scene.geometry, cameras, size, size);
    seen.surface = interpolate_surface(scene.geometry, seen.raster, cameras);
    seen.shape = seen_shape(seen.raster, seen.surface, scene.sphere);
    seen.own = scene.source->own(seen.surface);
    return seen;
}

EditView render_view(const EditScene& scene, const EditSettings& settings, NeuralTexture& field,
                     const SeenModel& seen, const ViewOptions& options) {
    const auto& [raster, surface, shape, own] = seen;
    const EnvironmentLight light =
        options.light ? *options.light : scene.lights->pick(settings.seed, options.iteration);
    EditView view;
    view.surface = surface;
    if (options.spread > 0) {
        view.surface.position =
            surface.position + offsets(surface.position, scene, settings, options);
    }
    view.material = scene.source->sample(view.surface, field, own);
    at::Tensor radiance = shade(surface, view.material, light);
    if (view.material.emissive.defined()) radiance = radiance + view.material.emissive;

    const int views = raster.views(), size = raster.width();
    const at::Tensor background =
        sample_backgrounds(settings.background, views, settings.seed, options.iteration)
            .to(scene.device)
            .view({views, 1, 1, 3})
            .expand({views, size, size, 3});
    at::Tensor picture = scatter(radiance, surface, raster, background);
    const int scale = size / settings.resolution;
    if (scale == 1) picture = antialias(picture, raster, scene.geometry);
    view.images = linear_to_srgb(picture.clamp(0, 1)).permute({0, 3, 1, 2});
    view.coverage = (raster.triangle >= 0).to(at::kFloat).unsqueeze(1);
    if (scale > 1) {
        view.images = at::avg_pool2d(view.images, scale);
        view.coverage = at::avg_pool2d(view.coverage, scale);
    }
    return view;
}

}  // namespace item3d
