#include "item3d/lighting/optimized/texel_light.h"

#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/equirectangular.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int change_height = 32, change_width = 64;
// Weights of the squared terms in the regularisation, chosen by eye.
constexpr float smoothness_weight = 9;
constexpr float start_weight = 0.006f;
constexpr float green_weight = 2;
constexpr float object_weight = 2;
constexpr float min_color = 0.02f;  ///< lower bound of the object's colour, before the logarithm
/// Direction of green in log RGB, perpendicular to the Planckian locus (physical_light.h).
const Vec3 green_direction = glm::normalize(Vec3(-0.65f, 1.0f, -0.35f));

at::Tensor as_direction(const Vec3& v) {
    return at::tensor({v.x, v.y, v.z}).view({1, 3, 1, 1});
}

}  // namespace

TexelLight::TexelLight(const Image& light, const LightModelOptions& options)
    : start_(to_tensor(options.from ? place_sun(light, {.from = *options.from, .strength = {}})
                                    : light)
                 .permute({2, 0, 1})
                 .unsqueeze(0)),
      change_(at::zeros({1, 3, change_height, 2 * change_height}).set_requires_grad(true)),
      solid_angles_(at::empty({1, 1, change_height, 1})) {
    for (int y = 0; y < change_height; ++y)
        solid_angles_[0][0][y][0] = texel_solid_angle(y, change_height);
    solid_angles_ = solid_angles_ / solid_angles_.mean();

    const Vec3 color = glm::log(glm::max(options.object_color, Vec3(min_color)));
    const Vec3 chroma = color - (color.x + color.y + color.z) / 3;
    const float length = glm::length(chroma);
    object_chroma_ = std::min(1.0f, length);
    object_direction_ = as_direction(length > 0 ? chroma / length : Vec3(0));
}

at::Tensor TexelLight::radiance(int height) const {
    const int width = 2 * height;
    // The map's left and right ends are neighbours, across which the interpolation must wrap.
    const at::Tensor around =
        at::cat({change_.narrow(3, change_width - 1, 1), change_, change_.narrow(3, 0, 1)}, 3);
    const int margin = width / change_width;
    const at::Tensor finer =
        at::upsample_bilinear2d(around, {height, width + 2 * margin}, /*align_corners=*/false);
    const at::Tensor light =
        at::adaptive_avg_pool2d(start_, {height, width}) * finer.narrow(3, margin, width).exp();
    return light[0].permute({1, 2, 0}).contiguous();
}

at::Tensor TexelLight::cube(int size) const {
    return equirectangular_to_cube(radiance(std::max(change_height, 2 * size)), size);
}

Image TexelLight::image(int height) const {
    const at::NoGradGuard no_grad;
    return to_image(radiance(std::max(change_height, height / change_height * change_height)));
}

at::Tensor TexelLight::regularization() const {
    const auto mean_square = [&](const at::Tensor& values) {
        return (values.square() * solid_angles_.narrow(2, 0, values.size(2))).mean();
    };
    const at::Tensor along = change_ - change_.roll(1, 3);
    const at::Tensor down =
        change_.narrow(2, 1, change_height - 1) - change_.narrow(2, 0, change_height - 1);
    const at::Tensor chroma = change_ - change_.mean(1, true);
    const at::Tensor green = (chroma * as_direction(green_direction)).sum(1, true);
    const at::Tensor object = (chroma * object_direction_).sum(1, true);
    return smoothness_weight * (mean_square(along) + mean_square(down)) +
           start_weight * mean_square(change_) + green_weight * mean_square(green) +
           object_weight * object_chroma_ * mean_square(object);
}

NamedTensors TexelLight::named_parameters() const {
    return {{"change", change_}};
}

}  // namespace item3d
