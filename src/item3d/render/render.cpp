#include "item3d/render/render.h"

#include "item3d/core/error.h"
#include "item3d/render/antialias.h"
#include "item3d/render/occlusion/indirect_light.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/scatter.h"

namespace item3d {
namespace {

/// Largest number of layers of a transparent model.
constexpr int max_layers = 8;

/// Shades one layer. Returns premultiplied radiance [1, H, W, 4].
at::Tensor shade_layer(const Raster& raster, const Geometry& geometry,
                       const TexturedMaterials& materials, const EnvironmentLight& light,
                       const std::vector<Camera>& camera, const RenderOptions& options) {
    Surface surface = interpolate_surface(geometry, raster, camera);
    add_uv_footprints(geometry, raster, surface);
    MaterialSample material = materials.sample(surface);
    if (options.occlusion) material = options.occlusion->shadowed(material, raster, surface);
    at::Tensor radiance;
    if (options.indirect) {
        const auto reflection = options.indirect->reflect(
            raster, surface, material.orm.narrow(1, 1, 1), options.indirect_rays, 0);
        radiance =
            shade_indirect(surface, material, light, options.indirect->bounce(raster, surface),
                           reflection, options.shade);
    } else {
        radiance = shade(surface, material, light, options.shade);
    }
    const at::Tensor alpha = material.alpha.defined()
                                 ? material.alpha.unsqueeze(1)
                                 : at::ones({surface.count(), 1}, radiance.options());
    return scatter(at::cat({radiance * alpha, alpha}, 1), surface, raster,
                   at::zeros({4}, radiance.options()));
}

at::Tensor render_view(const Geometry& geometry, const TexturedMaterials& materials,
                       const EnvironmentLight& light, const Camera& camera,
                       const RenderOptions& options) {
    const std::vector<Camera> cameras{camera};
    const int samples = options.supersampling;
    const int width = options.width * samples, height = options.height * samples;
    const Raster first = rasterize(geometry, cameras, width, height);
    at::Tensor image = shade_layer(first, geometry, materials, light, cameras, options);

    if (materials.has_alpha()) {
        Raster layer = first;
        for (int depth = 1; depth < max_layers; ++depth) {
            const at::Tensor open = (image.select(3, 3) < 0.999f).logical_and(layer.triangle >= 0);
            if (!open.any().item<bool>()) break;
            // Opaque pixels get a depth beyond every surface, so the next layer leaves them
            // unchanged.
            layer = rasterize(geometry, cameras, width, height,
                              at::where(open, layer.depth, at::full_like(layer.depth, 1e30f)));
            image = image + (1 - image.narrow(3, 3, 1)) *
                                shade_layer(layer, geometry, materials, light, cameras, options);
        }
    }
    if (options.background) {
        const Vec3 color = *options.background;
        const at::Tensor behind = at::tensor({color.x, color.y, color.z, 1.0f}, image.options());
        image = image + (1 - image.narrow(3, 3, 1)) * behind;
    }
    image = antialias(image, first, geometry);
    if (samples == 1) return image;
    return image.reshape({1, options.height, samples, options.width, samples, 4}).mean({2, 4});
}

}  // namespace

at::Tensor render(const Geometry& geometry, const TexturedMaterials& materials,
                  const EnvironmentLight& light, const std::vector<Camera>& cameras,
                  const RenderOptions& options) {
    ITEM3D_CHECK(options.supersampling >= 1 && options.width >= 1 && options.height >= 1,
                 "render: width, height and supersampling of at least 1");
    // Views are rendered one at a time, so that memory is needed for one supersampled image only.
    std::vector<at::Tensor> images;
    for (const Camera& camera : cameras)
        images.push_back(render_view(geometry, materials, light, camera, options));
    ITEM3D_CHECK(!images.empty(), "render: at least one camera");
    return at::cat(images);
}

}  // namespace item3d
