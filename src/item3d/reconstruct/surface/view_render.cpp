#include "item3d/reconstruct/surface/view_render.h"

#include "item3d/render/antialias.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "item3d/report/display_image.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

/// Number of rays per lobe. With fewer rays, the noise of interreflections penalizes reflective
/// materials.
constexpr int reflection_rays = 8;
constexpr float roughness_weight = 1.0f;
constexpr float metallic_weight = 1.0f;
constexpr float darkest_metal = 0.5f;
constexpr float roughest_metal = 0.7f;

/// Returns vectors in random directions, with lengths from `nearest` to `farthest`.
at::Tensor random_steps(std::int64_t rows, float nearest, float farthest, Random& random) {
    at::Tensor values = at::empty({rows, 3});
    float* out = values.data_ptr<float>();
    for (std::int64_t i = 0; i < rows; ++i) {
        Vec3 direction(random.normal(), random.normal(), random.normal());
        direction *= nearest * std::pow(farthest / nearest, static_cast<float>(random.uniform())) /
                     std::max(glm::length(direction), 1e-6f);
        for (int c = 0; c < 3; ++c)
            *out++ = direction[c];
    }
    return values;
}

/// Returns the indices of up to `count` evenly spaced rows. The first one is random.
at::Tensor some_rows(std::int64_t rows, std::int64_t count, Random& random) {
    const std::int64_t step = std::max<std::int64_t>(1, rows / std::max<std::int64_t>(1, count));
    const std::int64_t first = random.index(std::min(step, rows));
    return at::arange(first, rows, step, at::kLong);
}

}  // namespace

std::vector<TargetView> make_targets(const std::vector<Photograph>& views,
                                     std::array<Vec3, 2> bounds, int shrink) {
    std::vector<TargetView> targets;
    for (const Photograph& view : views) {
        TargetView target{view.name, view.camera, {}};
        fit_depth_range(target.camera, bounds);
        const Image image = shrink == 1 ? view.image
                                        : resize(view.image, std::max(1, view.image.width / shrink),
                                                 std::max(1, view.image.height / shrink));
        target.image = to_tensor(image).unsqueeze(0);
        targets.push_back(std::move(target));
    }
    return targets;
}

DrawnView as_drawn(const TargetView& view, const RenderedView& rendered) {
    return {view.camera, rendered.image.detach(), rendered.surface.pixel,
            rendered.surface.position.detach()};
}

RenderedView render_view(const Geometry& geometry, NeuralTexture& field,
                         const EnvironmentLight& light, const TargetView& view,
                         const ViewRenderOptions& options) {
    const std::vector<Camera> cameras{view.camera};
    const bool moves = options.motion.rotation.defined();
    const Geometry seen = moves ? options.motion.moved(geometry) : geometry;
    RenderedView result;
    result.raster = rasterize(seen, cameras, view.width(), view.height());
    result.surface = interpolate_surface(seen, result.raster, cameras);
    if (result.surface.count() == 0) {
        result.image = result.without_gain = at::zeros({1, view.height(), view.width(), 4});
        return result;
    }
    if (moves) options.motion.move_back(result.surface);
    result.material = field->forward(result.surface.position);
    MaterialSample& shaded = result.shaded;
    shaded = result.material;
    if (options.one_material) {
        shaded.base_color = shaded.base_color.mean(0, true).expand_as(shaded.base_color);
        shaded.orm = shaded.orm.mean(0, true).expand_as(shaded.orm);
    }
    if (options.base_color_factor.defined())
        shaded.base_color = shaded.base_color * options.base_color_factor;
    if (!options.normal_map) shaded.normal = at::Tensor();
    at::Tensor occlusion = at::ones_like(shaded.orm.narrow(1, 0, 1));
    if (options.occlusion != nullptr)
        occlusion = options.occlusion->at(result.raster, result.surface).unsqueeze(1);
    shaded.orm = at::cat({occlusion, shaded.orm.narrow(1, 1, 2)}, 1);
    at::Tensor radiance;
    if (options.indirect == nullptr) {
        radiance = shade(result.surface, shaded, light);
    } else {
        const IndirectLight& indirect = *options.indirect;
        radiance = shade_indirect(
            result.surface, shaded, light, indirect.bounce(result.raster, result.surface),
            indirect.reflect(result.raster, result.surface, shaded.orm.narrow(1, 1, 1),
                             reflection_rays, options.seed));
    }
    const at::Tensor values = at::cat({radiance, at::ones_like(radiance.narrow(1, 0, 1))}, 1);
    result.image = result.without_gain = antialias(
        scatter(values, result.surface, result.raster, at::zeros({4})), result.raster, seen);
    if (options.gain.defined())
        result.image = result.image * at::cat({options.gain, at::ones({1})});
    return result;
}

at::Tensor log_srgb(const at::Tensor& linear) {
    return linear_to_srgb(at::log1p(linear.clamp_min(0.0f)));
}

at::Tensor image_loss(const at::Tensor& rendered, const at::Tensor& target,
                      const at::Tensor& background) {
    const auto over = [&](const at::Tensor& image) {
        return image.narrow(3, 0, 3) + (1 - image.narrow(3, 3, 1)) * background;
    };
    const at::Tensor truth = over(target);
    at::Tensor shown = over(rendered);
    // Photographs clip at 1. Where the photograph is clipped, a brighter render is no error.
    shown = at::where((truth >= 0.999f).logical_and(shown > truth), truth, shown);
    return (log_srgb(shown) - log_srgb(truth)).abs().mean();
}

at::Tensor mask_loss(const at::Tensor& rendered, const at::Tensor& target) {
    return (rendered.select(3, 3) - target.select(3, 3)).square().mean();
}

at::Tensor smoothness_loss(NeuralTexture& field, const RenderedView& view, float nearest,
                           float farthest, std::int64_t count, Random& random) {
    const std::int64_t rows = view.surface.count();
    if (rows == 0) return at::zeros({});
    const at::Tensor chosen = some_rows(rows, count, random);
    const at::Tensor positions = view.surface.position.detach().index_select(0, chosen);
    const MaterialSample beside =
        field->forward(positions + random_steps(positions.size(0), nearest, farthest, random));
    const at::Tensor base_color = view.material.base_color.index_select(0, chosen);
    const at::Tensor orm = view.material.orm.index_select(0, chosen);
    const at::Tensor change = (orm - beside.orm).abs().mean(0);
    return (linear_to_srgb(base_color) - linear_to_srgb(beside.base_color)).abs().mean() +
           roughness_weight * change[1] + metallic_weight * change[2];
}

at::Tensor dark_metal_loss(const RenderedView& view) {
    if (view.surface.count() == 0) return at::zeros({});
    const at::Tensor lacks = (darkest_metal - view.material.base_color.amax(1)).clamp_min(0.0f);
    return (view.material.orm.select(1, 2) * lacks).mean();
}

at::Tensor rough_metal_loss(const RenderedView& view) {
    if (view.surface.count() == 0) return at::zeros({});
    const at::Tensor roughness = view.material.orm.select(1, 1).detach();
    return (view.material.orm.select(1, 2) * (roughness - roughest_metal).clamp_min(0.0f)).mean();
}

}  // namespace item3d
