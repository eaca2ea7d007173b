#include "item3d/region/preview.h"

#include "item3d/render/antialias.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/scatter.h"
#include "item3d/render/shade.h"
#include "item3d/report/display_image.h"

namespace item3d {
namespace {

constexpr float dimmed = 0.45f;   ///< relative brightness outside of the region
constexpr float colored = 0.75f;  ///< weight of the marking colour inside

}  // namespace

std::vector<Image> region_images(const Region& region, const Geometry& geometry,
                                 const TexturedMaterials& textured, const EnvironmentLight& light,
                                 const std::vector<Camera>& cameras, int pixels) {
    const at::NoGradGuard no_grad;
    std::vector<Image> images;
    for (const Camera& camera : cameras) {
        const std::vector<Camera> one{camera};
        const Raster raster = rasterize(geometry, one, 2 * pixels, 2 * pixels);
        const Surface surface = interpolate_surface(geometry, raster, one);
        const auto options = geometry.positions.options();
        const at::Tensor radiance = shade(surface, textured.sample(surface), light);
        const at::Tensor luminance =
            (radiance * at::tensor({0.2126f, 0.7152f, 0.0722f}, options)).sum(1, true);
        const at::Tensor grey = (dimmed * luminance).expand({-1, 3});
        const at::Tensor mark = at::tensor({1.0f, 0.24f, 0.0f}, options) * (0.3f + luminance);
        const at::Tensor inside = radiance + colored * (mark - radiance);
        const at::Tensor values =
            at::cat({grey.lerp(inside, region.weight(surface)), at::ones_like(luminance)}, 1);
        const at::Tensor image =
            antialias(scatter(values, surface, raster, at::zeros({4}, options)), raster, geometry);
        const at::Tensor small =
            at::avg_pool2d(image.permute({0, 3, 1, 2}), {2, 2}).permute({0, 2, 3, 1});
        images.push_back(to_display(to_image(small[0].contiguous().cpu())));
    }
    return images;
}

}  // namespace item3d
