#include "item3d/report/model_images.h"

#include "item3d/metrics/detail.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace item3d {
namespace {

constexpr float elevation = 0.32f;
constexpr float field_of_view = 0.6f;

/// Converts [N, H, W, 3 or more] linear to [N, 3, H, W] sRGB in [0, 1].
at::Tensor to_planes(const at::Tensor& linear) {
    return linear_to_srgb(linear.narrow(3, 0, 3).clamp(0, 1)).permute({0, 3, 1, 2}).contiguous();
}

}  // namespace

std::vector<Camera> image_cameras(const Model& model, int count, float first_azimuth) {
    return turntable(model.bounds(), count, elevation, field_of_view, first_azimuth);
}

ModelDrawing::ModelDrawing(const Model& model, EnvironmentLight light)
    : light_(std::move(light)),
      geometry_(Geometry::from_model(model, light_.diffuse.device())),
      materials_(model, light_.diffuse.device()) {}

at::Tensor ModelDrawing::draw(const std::vector<Camera>& cameras, int pixels) const {
    const at::NoGradGuard no_grad;
    RenderOptions options;
    options.width = pixels;
    options.height = pixels;
    std::vector<at::Tensor> images;
    for (const Camera& camera : cameras)
        images.push_back(render(geometry_, materials_, light_, {camera}, options));
    return at::cat(images);
}

at::Tensor draw_images(const Model& model, const EnvironmentLight& light,
                       const std::vector<Camera>& cameras, int pixels) {
    return ModelDrawing(model, light).draw(cameras, pixels);
}

int light_texels(int pixels) {
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(pixels, 16, 256))));
}

at::Tensor over_white(const at::Tensor& linear) {
    return to_planes(linear.narrow(3, 0, 3) + (1 - linear.narrow(3, 3, 1)));
}

double detail_kept(const at::Tensor& before, const at::Tensor& after) {
    return detail_correlation(to_planes(before), to_planes(after), before.select(3, 3));
}

}  // namespace item3d
