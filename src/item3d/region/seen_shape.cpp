#include "item3d/region/seen_shape.h"

#include "item3d/render/scatter.h"

namespace item3d {

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

}  // namespace item3d
