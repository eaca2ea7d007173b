#include "item3d/reconstruct/surface/trainable_light.h"

#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/equirectangular.h"

#include <cmath>

namespace item3d {

namespace {

constexpr int coarsest_height = 8;

/// Enlarges [h, 2h, 3] bilinearly to [height, 2 height, 3]. The map wraps around at its left and
/// right edges.
at::Tensor enlarged(const at::Tensor& level, int height) {
    const std::int64_t rows = level.size(0), scale = height / rows;
    if (scale == 1) return level;
    const at::Tensor planes = level.permute({2, 0, 1}).unsqueeze(0);
    const at::Tensor around =
        at::cat({planes.narrow(3, 2 * rows - 1, 1), planes, planes.narrow(3, 0, 1)}, 3);
    return at::upsample_bilinear2d(around, {height, (2 * rows + 2) * scale},
                                   /*align_corners=*/false)
        .narrow(3, scale, 2 * height)
        .squeeze(0)
        .permute({1, 2, 0});
}

}  // namespace

TrainableLight::TrainableLight(int height, float radiance) : height_(height) {
    for (int rows = coarsest_height; rows <= height; rows *= 2) {
        const float start = rows == coarsest_height ? std::log(radiance) : 0.0f;
        levels_.push_back(at::full({rows, 2 * rows, 3}, start, at::kFloat).set_requires_grad(true));
    }
    log_scale_ = at::zeros({3}).set_requires_grad(true);
    ITEM3D_CHECK(levels_.back().size(0) == height, "a power of two");
    solid_angle_ = at::empty({height, 1, 1});
    for (int y = 0; y < height; ++y)
        solid_angle_[y][0][0] = texel_solid_angle(y, height) / (4 * static_cast<double>(pi));
}

at::Tensor TrainableLight::radiance() const {
    at::Tensor logarithm = enlarged(levels_.front(), height_);
    for (std::size_t i = 1; i < levels_.size(); ++i)
        logarithm = logarithm + enlarged(levels_[i], height_);
    return (logarithm + log_scale_).exp().contiguous();
}

EnvironmentLight TrainableLight::prefiltered() const {
    return prefilter(equirectangular_to_cube(radiance(), height_));
}

Image TrainableLight::to_image() const {
    return item3d::to_image(radiance().detach());
}

void TrainableLight::take_color_from_gradients() {
    for (const at::Tensor& level : levels_)
        if (level.grad().defined())
            level.mutable_grad() = level.grad().mean(2, true).expand_as(level).contiguous();
}

at::Tensor TrainableLight::whiteness_loss() const {
    const at::Tensor values = radiance() * (log_scale_.detach() - log_scale_).exp();
    return ((values - values.mean(2, true)).abs() * solid_angle_).sum() / 3;
}

}  // namespace item3d
