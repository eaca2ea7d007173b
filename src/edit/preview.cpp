#include "item3d/edit/preview.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/scene/io/save.h"

namespace item3d {
namespace {

constexpr int picture_size = 256;
constexpr float elevation = 0.35f;
constexpr float field_of_view = 0.6f;
constexpr float background_gray = 0.75f;

}  // namespace

Preview::Preview(std::filesystem::path path, const EditScene& scene)
    : path_(std::move(path)),
      scene_(scene),
      cameras_(turntable(scene.model.bounds(), 3, elevation, field_of_view)) {}

void Preview::update(NeuralTexture& field) {
    if (!enabled_) return;
    const torch::NoGradGuard no_grad;
    const Raster raster = rasterize(scene_.geometry, cameras_, picture_size, picture_size);
    const Surface surface = interpolate_surface(scene_.geometry, raster, cameras_);
    const MaterialSample material = scene_.source->sample(surface, field);
    const torch::Tensor background = torch::full({3}, background_gray, scene_.device);
    torch::Tensor pictures =
        scatter(shade(surface, material, scene_.lights->front()), surface, raster, background);
    pictures = linear_to_srgb(antialias(pictures, raster, scene_.geometry).clamp(0, 1));
    try {
        save_image(path_, to_image(torch::cat(pictures.unbind(0), 1)));
    } catch (const Error& error) {
        warn(std::string("no more previews: ") + error.what());
        enabled_ = false;
    }
}

}  // namespace item3d
