#include "item3d/edit/field_pictures.h"

#include "item3d/render/antialias.h"
#include "item3d/render/pictures.h"
#include "item3d/render/scatter.h"

namespace item3d {
namespace {

constexpr float background_gray = 0.75f;  ///< linear

}  // namespace

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
    const at::Tensor pictures =
        scatter(shade(surface, material, light), surface, raster, background);
    return linear_to_srgb(antialias(pictures, raster, scene.geometry).clamp(0, 1));
}

}  // namespace item3d
